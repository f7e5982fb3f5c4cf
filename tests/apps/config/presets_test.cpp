// The presets `paper` and `mapclosures` by every key in which they differ from the defaults, what
// the paper or its published code (MapClosures 2.0.2) has there, and why groundloop's default is
// another. A key that is missing here, or here and not there, fails.
#include <map>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "apps/config/config.hpp"

namespace groundloop::apps {
namespace {

// section.key -> value of every option.
std::map<std::string, std::string> values_of(const std::string& preset) {
  Config config;
  if (!preset.empty()) read_config(config, preset);
  validate_config(config);
  std::istringstream yaml(to_yaml(config));
  std::map<std::string, std::string> values;
  std::string line, section;
  while (std::getline(yaml, line)) {
    const std::size_t colon = line.find(':');
    if (line.rfind("  ", 0) != 0) {
      section = line.substr(0, colon);
      continue;
    }
    std::istringstream rest(line.substr(colon + 1));
    rest >> values[section + "." + line.substr(2, colon - 2)];
  }
  return values;
}

struct Difference {
  const char* value;
  const char* why;
};
using Differences = std::map<std::string, Difference>;

const Differences kDetector{
    {"density_image.count", {"points", "counts of points depend on range, speed and LiDAR"}},
    {"features.max_features", {"500", "dense maps of 64 beams have more corners"}},
    {"features.fast_threshold", {"35", "layers of height make fainter images than points"}},
    {"features.border_px", {"0", "structure at the rim of a map has features too"}},
    {"matching.method", {"tree", "one tree misses a neighbour that differs in a bit of the way"}},
    {"matching.max_imbalance", {"0.1", "an unbalanced split is better than a long leaf"}},
    {"matching.nearest_only", {"true", "the nearest of several may not be the right one"}},
    {"consensus.method", {"ransac", "voting misses no set of inliers"}},
    {"consensus.max_matches", {"0", "voting grows with the square of the matches"}},
    {"consensus.unique_keypoints", {"false", "one keypoint in many matches is one witness"}},
    {"consensus.refinement", {"false", "the best of the trials is rarely the best there is"}},
    {"consensus.orientation_gate_deg", {"180", "inliers turn with the alignment"}},
    {"consensus.guided_bits", {"0", "what the search missed meets under the alignment"}},
};

const Differences kBackEnd{
    {"local_maps.max_path", {"1e+05", "who circles in place finishes maps"}},
    {"local_maps.max_scans", {"1000000", "likewise"}},
    {"closures.verification", {"false", "registration tells true from false, and refines"}},
    {"closures.pairwise_consistency", {"false", "periodic places pass registration"}},
    {"levelling.enabled", {"false", "what stands upright tells where odometry leans"}},
    {"pose_graph.robust", {"false", "one false closure spoils a trajectory"}},
    {"revisits.enabled", {"false", "offline, the solution is a source of closures"}},
    {"map_quality.pairs", {"0", "a worse result does not replace a better one in silence"}},
};

void expect_differences(const std::string& preset, const std::vector<Differences>& parts) {
  const std::map<std::string, std::string> defaults = values_of(""), values = values_of(preset);
  Differences expected;
  for (const Differences& part : parts) expected.insert(part.begin(), part.end());
  for (const auto& [key, value] : values) {
    const auto difference = expected.find(key);
    if (difference == expected.end()) {
      EXPECT_EQ(value, defaults.at(key)) << key << " differs without a reason";
      continue;
    }
    EXPECT_EQ(value, difference->second.value) << key << ": " << difference->second.why;
    EXPECT_NE(value, defaults.at(key)) << key << " does not differ any more";
    expected.erase(difference);
  }
  for (const auto& [key, difference] : expected) ADD_FAILURE() << "there is no key " << key;
}

TEST(Presets, PaperHasEveryStepAsThePaperHasIt) {
  const Differences own{
      {"ground_alignment.directions", {"1", "maps of hand-held sensors lean"}},
      {"ground_alignment.min_quality", {"0", "a plane that nothing lies on is none"}},
      {"consensus.trials", {"74", "a fixed number misses sets of few inliers"}},
  };
  expect_differences("paper", {kDetector, kBackEnd, own});
}

TEST(Presets, MapclosuresIsThePaperWithWhatItsCodeHasOtherwise) {
  const Differences own{
      {"ground_alignment.method", {"lowest", "normals tell ground from roofs and noise"}},
      {"ground_alignment.cell_size", {"5", "a metre follows the ground"}},
      {"ground_alignment.directions", {"1", "maps of hand-held sensors lean"}},
      {"ground_alignment.min_quality", {"0", "a plane that nothing lies on is none"}},
      {"matching.max_distance_bits", {"49", "under 50, not at most 50"}},
      {"matching.leaf_size", {"99", "a leaf of 100 is split, not one of 101"}},
      {"consensus.trials", {"37", "of its 74 every other one is a reflection"}},
  };
  expect_differences("mapclosures", {kDetector, kBackEnd, own});
}

}  // namespace
}  // namespace groundloop::apps
