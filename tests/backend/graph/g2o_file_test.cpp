#include "backend/graph/g2o_file.hpp"

#include <string>

#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/core/output_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

const std::string kInformation = " 1 0 0 0 0 0 2 0 0 0 0 3 0 0 0 4 0 0 5 0.5 6";
const std::string kGraph =
    "VERTEX_SE3:QUAT 7 0 0 0 0 0 0 1\n"
    "VERTEX_SE3:QUAT 3 1 2 3 0 0 0 2\n"
    "FIX 7\n"
    "VERTEX_XY 5 1 1\n"
    "\n"
    "EDGE_SE3:QUAT 7 3 1.5 0 0 0 0 0 1" +
    kInformation + "\n";

class G2oFileTest : public ::testing::Test {
 protected:
  G2oFile read(const std::string& text) {
    write_text_atomically(file_, text);
    return read_g2o(file_);
  }
  std::string message_of(const std::string& text) {
    try {
      (void)read(text);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }
  testing::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "graph.g2o";
};

TEST_F(G2oFileTest, ReadsVerticesEdgesAndFixedOnes) {
  const G2oFile file = read(kGraph);
  ASSERT_EQ(file.graph.vertices.size(), 2u);
  EXPECT_EQ(file.graph.vertices[0].id, 7);
  EXPECT_TRUE(file.graph.vertices[0].fixed);
  EXPECT_FALSE(file.graph.vertices[1].fixed);
  EXPECT_DOUBLE_EQ(file.graph.vertices[1].pose.rotation.w(), 1.0);
  ASSERT_EQ(file.graph.edges.size(), 1u);
  EXPECT_EQ(file.graph.edges[0].information(4, 5), 0.5);
  EXPECT_EQ(file.graph.edges[0].information(5, 4), 0.5);
  EXPECT_EQ(file.graph.edges[0].information(3, 3), 4.0);
  EXPECT_EQ(file.graph.edges[0].kind, EdgeKind::odometry);
}

TEST_F(G2oFileTest, CountsUnknownTags) {
  const G2oFile file = read(kGraph + "VERTEX_XY 6 1 1\nPARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\n");
  EXPECT_EQ(file.unknown_tags,
            (std::map<std::string, std::size_t>{{"PARAMS_SE3OFFSET", 1}, {"VERTEX_XY", 2}}));
}

TEST_F(G2oFileTest, KeepsIdsOrderAndEveryBit) {
  G2oFile file = read(kGraph);
  file.graph.vertices[1].pose =
      Pose(Eigen::Quaterniond(0.1, 0.2, 0.3, 0.4), Eigen::Vector3d(1.0 / 3.0, 1e-17, -2e8));
  write_g2o(file_, file.graph);
  const G2oFile again = read_g2o(file_);
  EXPECT_EQ(again.graph.vertices[0].id, 7);
  EXPECT_EQ(again.graph.vertices[1].pose.translation, file.graph.vertices[1].pose.translation);
  EXPECT_LT((again.graph.vertices[1].pose.rotation.coeffs() -
             file.graph.vertices[1].pose.rotation.coeffs())
                .norm(),
            1e-15);
  EXPECT_TRUE(again.graph.vertices[0].fixed);
  EXPECT_EQ(again.graph.edges[0].information, file.graph.edges[0].information);
}

TEST_F(G2oFileTest, NamesTheLineThatIsBroken) {
  EXPECT_NE(message_of(kGraph + "VERTEX_SE3:QUAT 8 0 0\n").find("line 7 ends before"),
            std::string::npos);
  EXPECT_NE(message_of(kGraph + "VERTEX_SE3:QUAT 8 0 0 nan 0 0 0 1\n").find("line 7 has 'nan'"),
            std::string::npos);
  EXPECT_NE(message_of(kGraph + "VERTEX_SE3:QUAT 8 0 0 0 0 0 0 0\n").find("line 7 has a quat"),
            std::string::npos);
  EXPECT_NE(message_of(kGraph + "VERTEX_SE3:QUAT 7 0 0 0 0 0 0 1\n").find("line 7 gives vertex 7"),
            std::string::npos);
  EXPECT_NE(message_of(kGraph + "FIX 12\n").find("line 7 names vertex 12"), std::string::npos);
  EXPECT_NE(message_of(kGraph + "VERTEX_SE3:QUAT 8 0 0 0 0 0 0 1 5\n").find("line 7 has more"),
            std::string::npos);
  EXPECT_NE(message_of(""), "");
}

TEST_F(G2oFileTest, NamesTheLineOfAnEdgeWithoutItsVertex) {
  const std::string edge = "EDGE_SE3:QUAT 7 11 1 0 0 0 0 0 1" + kInformation + "\n";
  EXPECT_NE(message_of(kGraph + edge).find("line 7 names vertex 11"), std::string::npos);
  // A vertex may follow its edge.
  EXPECT_EQ(message_of(kGraph + edge + "VERTEX_SE3:QUAT 11 0 0 0 0 0 0 1\n"), "");
}

TEST_F(G2oFileTest, NamesTheLineOfInformationThatIsNotPositiveSemiDefinite) {
  const std::string edge =
      "EDGE_SE3:QUAT 7 3 1 0 0 0 0 0 1 -1 0 0 0 0 0 2 0 0 0 0 3 0 0 0 4 0 0 5 0 6\n";
  const std::string message = message_of(kGraph + edge);
  EXPECT_NE(message.find("line 7 has information that is not positive semi-definite"),
            std::string::npos)
      << message;
}

TEST_F(G2oFileTest, OnlySuccessiveIdsAreOdometry) {
  std::string text;
  for (const int id : {0, 1, 2, 10}) {
    text += "VERTEX_SE3:QUAT " + std::to_string(id) + " 0 0 0 0 0 0 1\n";
  }
  for (const char* ends : {"0 1", "2 1", "0 2", "2 10"}) {
    text += std::string("EDGE_SE3:QUAT ") + ends + " 0 0 0 0 0 0 1" + kInformation + "\n";
  }
  const PoseGraph graph = read(text).graph;
  EXPECT_EQ(graph.edges[0].kind, EdgeKind::odometry);
  EXPECT_EQ(graph.edges[1].kind, EdgeKind::odometry);
  EXPECT_EQ(graph.edges[2].kind, EdgeKind::closure);
  EXPECT_EQ(graph.edges[3].kind, EdgeKind::odometry);
}

}  // namespace
}  // namespace groundloop
