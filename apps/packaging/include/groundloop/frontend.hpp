// The public face of groundloop::frontend: recordings of every format as scans in time order,
// odometry, and local maps. Errors in what is read are thrown as InputError, whose text names file,
// place and remedy.
//
// What is declared in the headers named here keeps its meaning within a minor version (0.1.x);
// headers that these include in turn are installed because they must be, and promise nothing.
#pragma once

#include "frontend/core/error.hpp"
#include "frontend/core/pcd.hpp"
#include "frontend/core/pose.hpp"
#include "frontend/core/progress.hpp"
#include "frontend/core/scan.hpp"
#include "frontend/core/trajectory.hpp"
#include "frontend/local_maps/local_map.hpp"
#include "frontend/local_maps/local_map_builder.hpp"
#include "frontend/odometry/odometry.hpp"
#include "frontend/recordings/recording.hpp"
