#include "loopclosure/loop_closure.hpp"
