// What a session writes of its graph is what comes back: odometry, the accepted closures, and none
// that was given up.
#include "backend/session/session_graph.hpp"

#include <gtest/gtest.h>

#include "backend/graph/g2o_file.hpp"
#include "backend/session/manifest.hpp"
#include "backend/session/stored_session.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/pcd.hpp"
#include "loopclosure/loop_database.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using testing::TemporaryFolder;

constexpr int kMaps = 7;

Pose along(double x, double y = 0.0) { return {Eigen::Quaterniond::Identity(), {x, y, 0.0}}; }

GraphEdge edge(int from, int to, EdgeKind kind, bool rejected = false) {
  GraphEdge e;
  e.from = from;
  e.to = to;
  e.T_from_to = along(100.0 * (to - from), rejected ? 30.0 : 0.0);
  e.information *= 10.0;
  e.kind = kind;
  e.rejected = rejected;
  return e;
}

// Odometry, a rejected closure, another between maps that follow one another in no order, and a
// closure of successive maps, which ids alone would take for odometry.
PoseGraph graph() {
  PoseGraph g;
  for (int m = 0; m < kMaps; ++m) g.vertices.push_back({m, along(100.0 * m), m == 0});
  g.edges.push_back(edge(5, 0, EdgeKind::closure, true));
  g.edges.push_back(edge(6, 1, EdgeKind::closure));
  g.edges.push_back(edge(3, 2, EdgeKind::settled));
  for (int m = 1; m < kMaps; ++m) g.edges.push_back(edge(m - 1, m, EdgeKind::odometry));
  return g;
}

TEST(SessionGraph, ComesBackWithTheKindOfEveryEdge) {
  const TemporaryFolder folder;
  write_session_graph(folder / "g.g2o", graph());
  const PoseGraph read = read_session_graph(folder / "g.g2o", kMaps, {{6, 1}, {3, 2}});
  ASSERT_EQ(read.edges.size(), 8U);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(read.edges[k].kind, EdgeKind::odometry) << k;
  for (std::size_t k = 6; k < 8; ++k) EXPECT_EQ(read.edges[k].kind, EdgeKind::closure) << k;
}

TEST(SessionGraph, IsRefusedWhereItsClosuresAreNotThoseOfTheTable) {
  const TemporaryFolder folder;
  write_session_graph(folder / "g.g2o", graph());
  EXPECT_THROW((void)read_session_graph(folder / "g.g2o", kMaps, {{6, 1}, {5, 0}}), InputError);
  EXPECT_THROW((void)read_session_graph(folder / "g.g2o", kMaps + 1, {{6, 1}, {3, 2}}), InputError);
  EXPECT_THROW((void)read_session_graph(folder / "g.g2o", kMaps, std::vector<ClosureEnds>(9)),
               InputError);
}

ClosureRecord row(int query, int reference, ClosureStatus status) {
  ClosureRecord c;
  c.query_map = query;
  c.reference_map = reference;
  c.status = status;
  c.T_query_reference = along(-95.0 * (query - reference));  // measured, before anything was solved
  c.initial_T_query_reference = c.T_query_reference;
  return c;
}

TEST(StoredSession, HasNoEdgeOfAClosureThatWasRejected) {
  const TemporaryFolder folder;
  const SessionFolder session(folder.path());
  std::filesystem::create_directories(folder / "local_maps");
  Trajectory trajectory;
  std::vector<LocalMapRecord> maps;
  LoopDatabase database{LoopClosureOptions()};
  for (int m = 0; m < kMaps; ++m) {
    trajectory.push_back({100000000LL * m, along(100.0 * m)});
    maps.push_back(
        {m, static_cast<std::size_t>(m), static_cast<std::size_t>(m), 1, along(100.0 * m)});
    write_pcd(session.local_map(m), {{0.0F, 0.0F, 0.0F}});
    MapDescription description;
    description.key = {0, m};
    database.insert(description);
  }
  write_tum(session.file("odometry.tum"), trajectory);
  write_tum(session.file("trajectory.tum"), trajectory);
  write_local_maps(session.file("local_maps.csv"), maps);
  write_closures(session.file("closures.csv"),
                 {row(5, 0, ClosureStatus::outlier), row(4, 0, ClosureStatus::low_overlap),
                  row(6, 1, ClosureStatus::accepted)});
  PoseGraph solved = graph();
  std::erase_if(solved.edges, [](const GraphEdge& e) { return e.kind == EdgeKind::settled; });
  write_session_graph(session.file("pose_graph.g2o"), solved);
  database.save(session.file("loop_database.bin"));
  Manifest manifest;
  manifest.stage = SessionStage::complete;
  manifest.identity = {"run", "1.2.3", "in", "conf"};
  manifest.scans = manifest.local_maps = kMaps;
  manifest.recording = {{"path", "somewhere"}};
  manifest.checksums = checksums_of(session, kMaps, 0);
  write_manifest(session, manifest);

  const StoredSession stored = load_session(folder.path(), {});
  ASSERT_EQ(stored.graph.edges.size(), 7U);
  for (const GraphEdge& e : stored.graph.edges) {
    EXPECT_FALSE(e.from == 5 && e.to == 0);
    EXPECT_EQ(e.kind, e.from == 6 ? EdgeKind::closure : EdgeKind::odometry);
  }
}

}  // namespace
}  // namespace groundloop
