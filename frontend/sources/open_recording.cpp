#include "frontend/recording.hpp"
