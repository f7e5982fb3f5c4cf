#include "tests/fuzz/targets/run_states.hpp"

#include <cmath>

namespace groundloop::fuzz {

Scan small_scan(std::size_t index) {
  Scan scan;
  scan.stamp = 1'000'000'000 + static_cast<Nanoseconds>(index) * 100'000'000;
  const float forward = 0.5F * static_cast<float>(index);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      const auto a = static_cast<float>(i), b = static_cast<float>(j);
      scan.points.emplace_back(10.0F - forward, 2.0F * a - 5.0F, b);
      scan.points.emplace_back(2.0F * a - forward, 6.0F, b);
      scan.points.emplace_back(2.0F * a - forward, 2.0F * b - 5.0F, -1.7F);
    }
  }
  return scan;
}

SessionIdentity run_identity() { return {"run", "0", "input", "configuration"}; }

RunState small_run_state(const SessionFolder& folder) {
  LocalMapOptions maps;
  maps.max_scans = 2;
  OdometryOptions odometry;
  odometry.max_iterations = 20;
  return {Odometry(odometry),
          LocalMapBuilder(maps),
          ClosureFinder(folder, LoopClosureOptions{}, ClosureOptions{}, VerificationOptions{},
                        RegistrationOptions{}),
          ScanKeeper(folder, KeptScanOptions{}),
          {},
          {},
          0,
          {},
          false};
}

void go_on(RunState& state) {
  for (int k = 0; k < 2; ++k) {
    const Scan scan = small_scan(state.trajectory.size());
    const RegisteredScan registered = state.odometry.add(scan, "scan");
    state.trajectory.push_back({scan.stamp, registered.T_world_scan});
    state.quality.push_back(registered.quality);
    state.keeper.add(registered.points, {}, registered.T_world_scan);
    if (const auto map = state.builder.add(registered.points, registered.T_world_scan))
      state.finder.add(*map);
  }
}

}  // namespace groundloop::fuzz
