// A recording with something done to it that a sound odometry hardly notices: coordinates rounded,
// scans left out, stamps shaken, the sensor mounted another way round, time run backwards. How much
// the result changes says how far it was luck (odometry_study.cpp).
#pragma once

#include <memory>
#include <string>

#include "frontend/recordings/recording.hpp"

namespace groundloop {

/// `perturbation` is one of
///   none
///   round1, round2, round4   coordinates rounded to so many millimetres
///   drop10                   every tenth scan left out
///   every2                   every second scan left out
///   stamps                   each stamp shifted by a tenth of the median interval, to either side
///   turnN                    the sensor mounted another way round, N = 1, 2, ...: all points
///   turned
///                            by one arbitrary rotation (and with it the grids that they fall into)
///   shakeN                   each scan seen from a head turned at random, by N degrees (standard
///                            deviation) about each axis
///   coverN                   N scans, from a third of the way on, see only a cover at 0.3 m
///   gapN                     N scans left out there
///   reverse                  the last scan first, time running backwards
/// Throws InputError where it is none of these.
[[nodiscard]] std::unique_ptr<Recording> perturb(std::unique_ptr<Recording> inner,
                                                 const std::string& perturbation);

}  // namespace groundloop
