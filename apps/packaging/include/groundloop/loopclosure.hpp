// The public face of groundloop::loopclosure: from the points of a local map to a description of
// its ground, and from descriptions to candidates for closures with their poses. See frontend.hpp
// for what is promised.
#pragma once

#include "loopclosure/describe.hpp"
#include "loopclosure/loop_closure.hpp"
#include "loopclosure/loop_database.hpp"
#include "loopclosure/options.hpp"
