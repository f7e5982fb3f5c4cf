// Several sessions in one frame. Closures between them are believed as consistent sets only, and a
// connection must be borne out by the places that overlap in it; connected sessions are solved
// together, each with its own edges. A session that cannot be connected stays as it is, in its own
// frame, and bends nothing.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "backend/graph/odometry_information.hpp"
#include "backend/judging/optimizer.hpp"
#include "backend/judging/pairwise_consistency.hpp"
#include "backend/mapping/session_solver.hpp"
#include "backend/merging/session_matching.hpp"
#include "backend/session/stored_session.hpp"
#include "frontend/core/options.hpp"

namespace groundloop {

struct ConnectionOptions {
  int min_closures = 2;
  int single_inliers = 20;
  double single_overlap = 0.5;
  double rival_share = 0.5;
  double min_predicted_overlap = 0.5;
  int max_trials = 12;
  double min_confirmed = 0.5;
  double min_evidence = 5.0;
  bool estimate_scale = true;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("min_closures", self.min_closures, Range{1, 1000}, "",
          "closures that agree pair by pair and so connect two sessions");
    field("single_inliers", self.single_inliers, Range{3, 10000}, "",
          "a closure that stands alone connects only with as many inliers, and");
    field("single_overlap", self.single_overlap, Range{0.0, 1.0}, "", "with this overlap");
    field("rival_share", self.rival_share, Range{0.0, 1.0}, "",
          "no connection where another alignment has more than this share of the largest set's "
          "closures: the places look alike");
    field("min_predicted_overlap", self.min_predicted_overlap, Range{0.01, 1.0}, "",
          "share of ground that two maps must have in common to be a test of the connection");
    field("max_trials", self.max_trials, Range{0, 10000}, "", "pairs tried to test a connection");
    field("min_confirmed", self.min_confirmed, Range{0.0, 1.0}, "",
          "share of the tested pairs, none of them the set's own, that registration must confirm; "
          "with fewer, or with none to be tested, the set needs");
    field(
        "min_evidence", self.min_evidence, Range{0.0, 1000.0}, "",
        "logarithm of the likelihood ratio, over both odometries, of the set against agreement by "
        "chance: 5, 150 to one, is what Kass and Raftery (1995) call very strong");
    field(
        "estimate_scale", self.estimate_scale, OnOff{}, "",
        "where too few closures between two sessions agree, ask them how much more the odometries "
        "err than the sessions say; a session that met no place twice could not tell");
  }
};

struct MergeOptions {
  SessionMatchingOptions matching;
  ConsistencyOptions consistency;
  ConnectionOptions connection;
  OdometryInformationOptions odometry_information;
  OptimizerOptions optimizer;
  RevisitOptions revisits;
  /// Called with the matches of a pair once they are known, so that a caller may keep them.
  std::function<void(const PairMatches&)> on_matched;
};

/// One recording in the merged session.
struct MergedPart {
  const SessionPart* source = nullptr;
  std::size_t session = 0;  ///< place of its session in the input
  int first_map = 0;        ///< added to a map's number it gives its id in the merged session
  std::size_t first_scan = 0;
  std::size_t first_scan_file = 0;  ///< of its kept scans, in the merged session's numbers
  int frame = 0;  ///< the recording in whose frame its poses are; its own number: its own frame
  bool fixed = false;  ///< held as the reference map
  /// Of its odometry's standard deviations, over what its session says; found while connecting.
  double odometry_scale = 1.0;
  Trajectory odometry, trajectory;
  std::vector<LocalMapRecord> maps;  ///< numbered in the recording, poses in the frame
};

/// What was found between two recordings.
struct SessionPair {
  int reference = 0, query = 0;
  std::size_t candidates = 0, verified = 0, accepted = 0;
  bool from_file = false;
  bool joined_before = false;   ///< the input had them in one frame already; nothing was matched
  std::size_t shared_maps = 0;  ///< of the query, that lie on ground of the reference
};

struct MergeTimes {
  double matching = 0, verification = 0, optimisation = 0;
};

struct MergeResult {
  std::vector<MergedPart> parts;
  std::vector<SessionPair> pairs;
  PoseGraph graph;
  std::vector<ClosureRecord> closures;  ///< of the inputs in their order, then between them
  std::vector<std::string> notes;       ///< connections made and refused, one sentence each
  OptimizationSummary summary;
  MergeTimes times;
};

/// `matches` stand in for matching their pairs; those whose fingerprints differ are left aside with
/// a note. `fixed` is the place of the session to hold, if any. Names of recordings must differ.
[[nodiscard]] MergeResult merge_sessions(const std::vector<StoredSession>& sessions,
                                         const std::vector<PairMatches>& matches,
                                         std::optional<std::size_t> fixed,
                                         const MergeOptions& options, const Progress& progress);

}  // namespace groundloop
