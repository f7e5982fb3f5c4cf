// From odometry and closures to the optimised trajectory of one session: odometry is levelled by
// what stands upright, the graph of key poses (one a local map) decides which closures hold,
// registration adds those that the solution reveals, and the graph of all scans spreads the
// correction.
#pragma once

#include <vector>

#include "backend/graph/odometry_information.hpp"
#include "backend/judging/odometry_scale.hpp"
#include "backend/judging/optimizer.hpp"
#include "backend/mapping/closure_finder.hpp"
#include "backend/mapping/levelling.hpp"
#include "backend/mapping/revisit_check.hpp"
#include "backend/session/session.hpp"
#include "frontend/core/progress.hpp"
#include "frontend/core/trajectory.hpp"

namespace groundloop {

struct RevisitOptions {
  bool enabled = true;
  int max_rounds = 3;
  double max_distance = 3.0;
  double max_angle_deg = 4.0;
  double min_predicted_overlap = 0.2;
  double min_overlap = 0.45;
  double min_agreement = 0.48;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("enabled", self.enabled, OnOff{}, "",
          "try pairs of maps that overlap in the solution but have no closure");
    field("max_rounds", self.max_rounds, Range{1, 100}, "",
          "rounds of trying and solving; they end once nothing is gained");
    field("max_distance", self.max_distance, Range{0.1, 100.0}, "m",
          "registration may move a pair this far from the solution; farther says that one of them "
          "is wrong");
    field("max_angle_deg", self.max_angle_deg, Range{0.1, 90.0}, "deg", "the same in rotation");
    field("min_predicted_overlap", self.min_predicted_overlap, Range{0.01, 1.0}, "",
          "share of the smaller map's ground area that a pair must have in common to be tried");
    field("min_overlap", self.min_overlap, Range{0.0, 1.0}, "",
          "volumetric overlap asked of them: no detector vouches for these pairs, so more than of "
          "its candidates");
    field("min_agreement", self.min_agreement, Range{-1.0, 1.0}, "",
          "agreement of tall structure asked of them; the solution itself is a witness");
  }
};

struct SolverInput {
  const Trajectory& odometry;  ///< that the local maps were built from
  LevellingOptions levelling;
  OdometryInformationOptions odometry_information;
  OptimizerOptions optimizer;
  RevisitOptions revisits;
  MapQualityOptions map_quality;
  VerificationOptions verification;
  RegistrationOptions registration;
  bool pairwise_consistency = true;
  /// Of the steps of odometry (loose_steps in odometry_trust.hpp); none where it is empty.
  std::vector<Vector6d> loose = {};
};

struct SessionSolution {
  Trajectory trajectory;            ///< one pose a scan, optimised
  std::vector<Pose> T_world_map;    ///< one a local map, equal to its first scan's
  PoseGraph key_graph;              ///< as solved
  Levelling levelling;              ///< of the odometry, before closures
  OptimizationSummary key_summary;  ///< of the key-pose graph
  OptimizationSummary summary;      ///< of the graph of all scans
  std::size_t revisits_tried = 0;
  std::size_t revisits_accepted = 0;
  MapQuality map_quality;       ///< at revisits, by odometry and in the solution
  double odometry_scale = 1.0;  ///< found factor on the odometry's standard deviations
  std::vector<ScaleTrial> scale_trials;
  double optimisation_seconds = 0.0;
  double verification_seconds = 0.0;
  double levelling_seconds = 0.0;
};

/// The key-pose graph of the solution has map ids as vertices, levelled odometry between successive
/// maps, and the accepted closures as `EDGE query reference`, carried to the levelled odometry.
/// Solves, and gives every closure its final status and weight; closures found on the way are added
/// to `closures`.
[[nodiscard]] SessionSolution solve_session(const SolverInput& input,
                                            const std::vector<LocalMapRecord>& maps,
                                            MapStore& store, std::vector<ClosureRecord>& closures,
                                            const Progress& progress);

}  // namespace groundloop
