#include <algorithm>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "backend/graph/between_factor.hpp"
#include "backend/graph/factors.hpp"
#include "backend/graph/g2o_file.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "tests/support/false_closures.hpp"
#include "tests/support/simulated_graph.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

struct Outcome {
  int code = -1;
  std::string out;
  std::string err;
};

class OptimizeCommand : public ::testing::Test {
 protected:
  Outcome optimize(const std::string& arguments) {
    const std::string out = (folder_ / "stdout").string();
    const std::string err = (folder_ / "stderr").string();
    const std::string command =
        std::string(GROUNDLOOP_BINARY) + " optimize " + arguments + " >" + out + " 2>" + err;
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(out), read_text(err)};
  }

  testing::TemporaryFolder folder_;
  std::string in_ = (folder_ / "in.g2o").string();
  std::string out_ = (folder_ / "out.g2o").string();
};

TEST_F(OptimizeCommand, KeepsIdsAndOrderAndPrintsOneJsonObject) {
  testing::SimulatedGraph simulated = testing::simulate_graph(400, 20, 150, 1);
  std::swap(simulated.graph.vertices[10], simulated.graph.vertices[300]);
  write_g2o(in_, simulated.graph);
  write_text_atomically(in_, read_text(in_) + "VERTEX_TRACKXYZ 1000 1 2 3\n");
  const Outcome outcome = optimize(in_ + " --out " + out_ + " --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("VERTEX_TRACKXYZ"), std::string::npos);
  const auto json = nlohmann::json::parse(outcome.out);
  const PoseGraph solved = read_g2o(out_).graph;
  EXPECT_NEAR(json["cost"]["before"], cost(simulated.graph), 1e-9 * cost(simulated.graph));
  EXPECT_NEAR(json["cost"]["after"], cost(solved), 1e-6 * cost(solved));
  EXPECT_NEAR(json["chi2_g2o"], chi2_g2o(solved), 1e-6 * chi2_g2o(solved));
  EXPECT_GT(json["iterations"], 0);
  EXPECT_EQ(json["edges_rejected"], 0);
  EXPECT_EQ(json["unknown_tags"]["VERTEX_TRACKXYZ"], 1);
  for (const char* phase : {"read", "initialisation", "solve", "write", "total"}) {
    EXPECT_TRUE(json["seconds"].contains(phase)) << phase;
  }
  ASSERT_EQ(solved.vertices.size(), simulated.graph.vertices.size());
  ASSERT_EQ(solved.edges.size(), simulated.graph.edges.size());
  for (std::size_t i = 0; i < solved.vertices.size(); ++i) {
    EXPECT_EQ(solved.vertices[i].id, simulated.graph.vertices[i].id);
  }
  for (std::size_t k = 0; k < solved.edges.size(); ++k) {
    EXPECT_EQ(solved.edges[k].from, simulated.graph.edges[k].from);
    EXPECT_EQ(solved.edges[k].to, simulated.graph.edges[k].to);
  }
}

TEST_F(OptimizeCommand, RobustNamesTheEdgesItRejects) {
  const testing::SimulatedGraph simulated = testing::simulate_graph(400, 20, 150, 1);
  PoseGraph graph = simulated.graph;
  testing::FalseClosures(simulated.truth, testing::closure_covariance().inverse(), 2)
      .add_random(graph, 10, 20);
  write_g2o(in_, graph);
  const Outcome outcome = optimize(in_ + " --out " + out_ + " --json --robust");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  ASSERT_EQ(json["edges_rejected"], 10);
  for (std::size_t k = 0; k < 10; ++k) {
    const GraphEdge& edge = graph.edges[simulated.graph.edges.size() + k];
    EXPECT_EQ(json["rejected"][k], (nlohmann::json{edge.from, edge.to}));
  }
  EXPECT_EQ(read_g2o(out_).graph.edges.size(), graph.edges.size());
}

TEST_F(OptimizeCommand, TwoCallsGiveEqualBytesForEveryThreadCount) {
  write_g2o(in_, testing::simulate_graph(500, 20, 150, 4).graph);
  const std::string other = (folder_ / "other.g2o").string();
  ASSERT_EQ(optimize(in_ + " --out " + out_ + " --robust --threads 1").code, 0);
  ASSERT_EQ(optimize(in_ + " --out " + other + " --robust --threads 2").code, 0);
  EXPECT_EQ(read_text(out_), read_text(other));
}

TEST_F(OptimizeCommand, FailsWithOneLineAndCode2) {
  write_text_atomically(in_, "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 0 0 x\n");
  const Outcome broken = optimize(in_ + " --out " + out_);
  EXPECT_EQ(broken.code, 2);
  EXPECT_NE(broken.err.find("in.g2o: line 2 has 'x'"), std::string::npos) << broken.err;
  EXPECT_EQ(std::count(broken.err.begin(), broken.err.end(), '\n'), 1);
  EXPECT_FALSE(std::filesystem::exists(out_));
  const Outcome missing = optimize((folder_ / "nowhere.g2o").string() + " --out " + out_);
  EXPECT_EQ(missing.code, 2);
  EXPECT_NE(missing.err.find("nowhere.g2o"), std::string::npos);
}

}  // namespace
}  // namespace groundloop
