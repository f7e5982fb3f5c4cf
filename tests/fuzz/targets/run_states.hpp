// A run of a few small scans, as far as a checkpoint keeps it.
#pragma once

#include "backend/mapping/checkpoint.hpp"

namespace groundloop::fuzz {

/// Two walls and the ground, 108 points, seen from a sensor that moves on half a metre a scan.
[[nodiscard]] Scan small_scan(std::size_t index);
[[nodiscard]] SessionIdentity run_identity();
[[nodiscard]] RunState small_run_state(const SessionFolder& folder);
/// Two scans more, and the local map that they complete; InputError is the end of it.
void go_on(RunState& state);

}  // namespace groundloop::fuzz
