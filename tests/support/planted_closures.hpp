// False closures planted among those of a session, with tight information, to test that the back
// end holds against them: random ones, groups of neighbouring maps that agree with each other, and
// ones at true places but 5 to 20 m off. They pass for verified ones and have no matches.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "backend/session/session.hpp"
#include "frontend/core/trajectory.hpp"

namespace groundloop::testing {

struct PlantedClosures {
  int random = 0;      ///< between maps drawn at random, up to 50 m and at any heading
  int groups = 0;      ///< between successive maps that agree: one street taken for another
  int group_size = 4;  ///< closures of a group
  int near = 0;        ///< 5 to 20 m off, each beside one that verification accepted
  int seed = 1;
};

class Planter {
 public:
  Planter(const PlantedClosures& options, const Trajectory& odometry,
          const std::vector<LocalMapRecord>& maps, std::vector<ClosureRecord>& closures)
      : options_(options), maps_(static_cast<int>(maps.size())), closures_(closures) {
    generator_.seed(static_cast<std::uint64_t>(options.seed));
    for (const LocalMapRecord& map : maps) T_world_map_.push_back(odometry[map.first_scan].pose);
  }

  void plant() {
    const std::vector<ClosureRecord> found = closures_;
    if (maps_ > kApart + 1) {
      for (int i = 0; i < options_.random; ++i) add_group(1);
    }
    if (maps_ > kApart + 2 * options_.group_size) {
      for (int i = 0; i < options_.groups; ++i) add_group(options_.group_size);
    }
    std::vector<const ClosureRecord*> accepted;
    for (const ClosureRecord& c : found) {
      if (c.status == ClosureStatus::accepted) accepted.push_back(&c);
    }
    for (int i = 0; i < options_.near && !accepted.empty(); ++i) {
      const ClosureRecord& c = *accepted[draw(static_cast<int>(accepted.size()))];
      add(c.reference_map, c.query_map, c.T_query_reference * offset());
    }
  }

 private:
  static constexpr int kApart = 4;  // maps, as the detector keeps

  // mt19937_64 by hand: distributions differ from one standard library to another.
  int draw(int below) { return static_cast<int>(generator_() % static_cast<std::uint64_t>(below)); }
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(generator_() >> 11U) * 0x1p-53;
  }

  Pose offset() {
    const double direction = uniform(-M_PI, M_PI);
    const double distance = uniform(5.0, 20.0);
    return {exp_so3(Eigen::Vector3d(0.0, 0.0, uniform(-0.05, 0.05))),
            Eigen::Vector3d(distance * std::cos(direction), distance * std::sin(direction), 0.0)};
  }

  // One false alignment of two stretches of the way, claimed by `size` successive pairs of maps.
  void add_group(int size) {
    int reference = 0;
    int query = 0;
    while (query - reference < kApart + size - 1) {
      reference = draw(maps_ - size + 1);
      query = draw(maps_ - size + 1);
    }
    const Pose T_query_reference(
        exp_so3(Eigen::Vector3d(0.0, 0.0, uniform(-M_PI, M_PI))),
        Eigen::Vector3d(uniform(-50.0, 50.0), uniform(-50.0, 50.0), uniform(-0.5, 0.5)));
    for (int i = 0; i < size; ++i) {
      const Pose on = T_world_map_[query + i].inverse() * T_world_map_[query];
      const Pose back = T_world_map_[reference].inverse() * T_world_map_[reference + i];
      add(reference + i, query + i, on * T_query_reference * back);
    }
  }

  void add(int reference, int query, const Pose& T_query_reference) {
    ClosureRecord record;
    record.reference_map = reference;
    record.query_map = query;
    record.status = ClosureStatus::accepted;
    record.T_query_reference = record.initial_T_query_reference = T_query_reference;
    // 5 cm and 0.2 degrees.
    record.information.diagonal() << 400.0, 400.0, 400.0, 8e4, 8e4, 8e4;
    closures_.push_back(std::move(record));
  }

  const PlantedClosures& options_;
  int maps_;
  std::vector<ClosureRecord>& closures_;
  std::vector<Pose> T_world_map_;
  std::mt19937_64 generator_;
};

/// Adds closures that pass for verified ones to `closures`. Maps need to be more than a handful for
/// there to be pairs to draw from; else nothing is planted.
inline void plant_false_closures(const PlantedClosures& options, const Trajectory& odometry,
                                 const std::vector<LocalMapRecord>& maps,
                                 std::vector<ClosureRecord>& closures) {
  Planter(options, odometry, maps, closures).plant();
}

}  // namespace groundloop::testing
