// revisits RECORDING: where a recording comes back to, by its local maps; with the verdict on each.
#include <iostream>

#include <groundloop/backend.hpp>
#include <groundloop/frontend.hpp>
#include <groundloop/loopclosure.hpp>

using namespace groundloop;

int main(int argc, char** argv) try {
  const auto recording = open_recording(argc > 1 ? argv[1] : ".");
  Odometry odometry{OdometryOptions()};
  LocalMapBuilder builder{LocalMapOptions()};
  LoopDatabase database{LoopClosureOptions()};
  std::vector<LocalMap> maps;
  const auto keep = [&](std::optional<LocalMap> map) {
    if (!map) return;
    maps.push_back(std::move(*map));
    const Points& query = maps.back().points;
    const RegistrationTarget target(query, RegistrationOptions());
    MapDescription description = describe_map({0, maps.back().id}, query, {});
    for (const ClosureCandidate& c : database.query(description)) {
      const Points& reference = maps[c.reference.map].points;
      const auto verdict = verify_closure(target, query, reference, c.T_query_reference);
      std::cout << "map " << c.query.map << " meets map " << c.reference.map << ": "
                << to_string(verdict.status) << ", overlap " << verdict.overlap << "\n";
    }
    database.insert(std::move(description));
  };
  for (std::size_t i = 0; i < recording->size(); ++i) {
    const RegisteredScan scan = odometry.add(recording->read(i), "scan " + std::to_string(i));
    keep(builder.add(scan.points, scan.T_world_scan));
  }
  keep(builder.finish());
  std::cout << recording->size() << " scans, " << maps.size() << " local maps\n";
} catch (const InputError& error) {
  std::cerr << error.what() << "\n";
  return 2;
}
