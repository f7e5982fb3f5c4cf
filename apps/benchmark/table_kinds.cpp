#include "apps/benchmark/measures.hpp"

namespace groundloop::apps {

const std::vector<TableKind>& table_kinds() {
  static const std::vector<TableKind> kinds{
      {"odometry",
       "Odometry",
       "recording",
       false,
       "",
       {"scans", "path", "drift", "drift_turn", "rpe", "rpe_turn", "ape_odometry"}},
      {"trajectory",
       "Trajectories before and after closing loops",
       "recording",
       false,
       "",
       {"ape_odometry", "ape_odometry_horizontal", "ape_odometry_vertical", "ape", "ape_horizontal",
        "ape_vertical", "ape_turn"}},
      {"closures",
       "Closures within sessions",
       "recording",
       true,
       "Before any verification.",
       {"references", "uncertain", "eligible", "chance", "ap", "r1", "f1", "ap_certain",
        "r1_certain", "ap_pose", "r1_pose"}},
      {"closures_between",
       "Closures between sessions",
       "pair",
       true,
       "Before any verification; the query's features are never inserted.",
       {"references", "uncertain", "eligible", "chance", "ap", "r1", "f1", "ap_certain",
        "r1_certain", "ap_pose", "r1_pose"}},
      {"final_graph",
       "Closures in the final graph",
       "recording",
       false,
       "",
       {"references", "graph_true", "graph_false", "graph_wrong", "graph_recall"}},
      {"closure_poses",
       "Poses of true closures",
       "recording",
       false,
       "Initial: the detector's own; refined: by registration, in the final graph.",
       {"initial_meeting_closures", "initial_meeting_m", "initial_meeting_rms_m",
        "initial_meeting_deg", "initial_meeting_rms_deg", "refined_meeting_closures",
        "refined_meeting_m", "refined_meeting_rms_m", "refined_meeting_deg",
        "refined_meeting_rms_deg", "initial_origin_m", "initial_origin_deg", "refined_origin_m",
        "refined_origin_deg", "overlap_error"}},
      {"merging",
       "Merging",
       "pair",
       false,
       "",
       {"joined", "right", "relative", "relative_turn", "joint_ape", "between_accepted",
        "between_precision", "merge_seconds"}},
      {"map_quality",
       "Map quality",
       "recording",
       false,
       "Where places were seen twice; no ground truth enters.",
       {"revisits", "thickness_before", "thickness", "entropy_before", "entropy", "given_up"}},
      {"uncertainty", "Calibration of the uncertainty", "recording", false, "", {"odometry_scale"}},
      {"time",
       "Time and memory",
       "recording",
       false,
       "",
       {"scans_per_map", "t_read", "t_odometry", "t_ground_alignment", "t_density_image",
        "t_features", "t_matching", "t_consensus", "t_verification", "t_optimisation",
        "scans_per_second", "processor", "memory"}},
      {"speed", "Speed", "recording", true, "", {"speed"}},
  };
  return kinds;
}

const TableKind* find_table_kind(std::string_view name) {
  for (const TableKind& kind : table_kinds()) {
    if (kind.name == name) return &kind;
  }
  return nullptr;
}

}  // namespace groundloop::apps
