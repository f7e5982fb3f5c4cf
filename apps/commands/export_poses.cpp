#include "apps/commands/export_poses.hpp"

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "apps/config/config.hpp"
#include "backend/graph/marginals.hpp"
#include "backend/mapping/scan_uncertainty.hpp"
#include "backend/session/table_row.hpp"
#include "backend/session/uncertainty_table.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop::apps {
namespace {

std::string header(const PoseExport& request) {
  std::string text = request.from ? "from_scan,to_scan" : "scan,stamp_s";
  text += ",tx,ty,tz,qx,qy,qz,qw";
  if (request.uncertainty)
    text += ",sigma_tx,sigma_ty,sigma_tz,sigma_rx,sigma_ry,sigma_rz," + covariance_header();
  return text + "\n";
}

void append_uncertainty(std::string& text, const Matrix6d& covariance) {
  for (int i = 0; i < 6; ++i) text += "," + to_text(std::sqrt(covariance(i, i)));
  append_covariance(text, covariance);
}

void check_scans(const PoseExport& request, const PoseGraph& graph) {
  if (request.from.has_value() != request.to.has_value())
    throw InputError("--from and --to go together: give both, or neither");
  if (!request.from) return;
  for (const std::size_t scan : {*request.from, *request.to}) {
    if (scan >= graph.vertices.size()) {
      throw InputError(request.session.string() + ": has no scan " + std::to_string(scan) +
                       ", its last is " + std::to_string(graph.vertices.size() - 1));
    }
  }
  const std::vector<int> component = connected_components(graph);
  if (component[*request.from] != component[*request.to])
    throw InputError("the two scans lie in frames that nothing joins; give two of one frame");
}

std::string relative_row(const PoseExport& request, const PoseGraph& graph) {
  const auto from = static_cast<int>(*request.from), to = static_cast<int>(*request.to);
  std::string text = std::to_string(from) + "," + std::to_string(to);
  if (!request.uncertainty) {
    append_pose(text, graph.vertices[from].pose.inverse() * graph.vertices[to].pose);
    return text + "\n";
  }
  const std::array<int, 1> wanted{to};
  const RelativePose between = Marginals(graph, gauge(graph)).between(from, wanted).front();
  append_pose(text, between.T_from_to);
  append_uncertainty(text, between.covariance);
  return text + "\n";
}

}  // namespace

std::size_t export_poses(const PoseExport& request) {
  Config config;
  read_config(config, (request.session / "config.yaml").string());
  const StoredSession session = load_session(request.session, config.slam.loop_closure);
  const PoseGraph graph = graph_of_scans(session, config.slam.odometry_information);
  check_scans(request, graph);
  std::string text = header(request);
  if (request.from) {
    write_text_atomically(request.out, text + relative_row(request, graph));
    return 1;
  }
  std::optional<std::vector<Matrix6d>> covariances;
  if (request.uncertainty) {
    covariances = pose_covariances(graph);
    if (!covariances) {
      throw InputError(request.session.string() +
                       ": its pose graph leaves a pose open, so nothing is known of its error; "
                       "export without --uncertainty");
    }
  }
  std::size_t scan = 0;
  for (const SessionPart& part : session.parts) {
    for (const StampedPose& sample : part.trajectory) {
      text += std::to_string(scan) + "," + seconds_text(sample.stamp);
      append_pose(text, sample.pose);
      if (request.uncertainty) append_uncertainty(text, (*covariances)[scan]);
      text += '\n';
      ++scan;
    }
  }
  write_text_atomically(request.out, text);
  return scan;
}

}  // namespace groundloop::apps
