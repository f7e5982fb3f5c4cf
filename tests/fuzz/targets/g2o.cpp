// Pose graphs in g2o's text format: what is read is written and read again the same.
#include "backend/graph/g2o_file.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/scratch_folder.hpp"

GROUNDLOOP_FUZZ_TARGET(g2o) {
  const G2oFile read = read_g2o(scratch_file("graph.g2o", text_of(input)));
  const auto again = scratch_folder() / "again.g2o";
  write_g2o(again, read.graph);
  const G2oFile second = read_g2o(again);
  FUZZ_PROMISE(second.graph.vertices.size() == read.graph.vertices.size());
  FUZZ_PROMISE(second.graph.edges.size() == read.graph.edges.size());
  for (const GraphVertex& vertex : second.graph.vertices)
    FUZZ_PROMISE(vertex.pose.translation.allFinite() && vertex.pose.rotation.coeffs().allFinite());
}
