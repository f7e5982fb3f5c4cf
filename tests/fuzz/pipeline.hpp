// What a reader lets through goes on as in a run: preprocessing, odometry, local maps, ground
// alignment, density image and features. What comes out must be finite, whatever went in.
#pragma once

#include "frontend/recordings/recording.hpp"

namespace groundloop::fuzz {

/// Promises of every scan that a reader returns: points are returns, times are one a point, finite,
/// and within an hour of the stamp.
void expect_sound(const Scan& scan);

/// Scans, one after the other, through the front end; those that are refused are left out.
void process(const std::vector<Scan>& scans);

/// Every promise of a recording; its first scans go through the front end.
void use(Recording& recording);

}  // namespace groundloop::fuzz
