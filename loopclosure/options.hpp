// Options of the loop-closure module (Sec. 3.2 to 3.6 of the paper). Values the paper does not give
// are marked so; every stage that can be switched off says what then stands in its place.
#pragma once

#include <string>

#include "frontend/core/options.hpp"

namespace groundloop {

struct GroundAlignmentOptions {
  bool enabled = true;
  std::string method = "normals";
  int directions = 6;
  double cell_size = 1.0;
  double normal_gate = 0.95;
  int max_iterations = 10;
  double weight_scale = 0.3;
  double min_quality = 0.05;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("enabled", self.enabled, OnOff{}, "", "off: maps are projected along their own z axis");
    field(
        "method", self.method, Choices{"normals", "lowest"}, "",
        "normals: lowest voxels whose normals agree, as in the paper; lowest: a plane through the "
        "lowest points alone, as its published code 2.0.2 has it");
    field("directions", self.directions, Range{1, 6}, "",
          "directions along which the lowest voxels are sought, for maps that lean; 1 is the map's "
          "own z axis, as in the paper");
    field("cell_size", self.cell_size, Range{0.1, 10.0}, "m",
          "edge of the voxels, or with 'lowest' of the cells, whose lowest are sampled");
    field("normal_gate", self.normal_gate, Range{0.5, 0.9999}, "",
          "cosine to the principal normal above which a cell is ground");
    field("max_iterations", self.max_iterations, Range{0, 100}, "", "least-squares steps");
    field("weight_scale", self.weight_scale, Range{0.01, 10.0}, "m",
          "least standard deviation of the Gaussian weight (not given in the paper)");
    field("min_quality", self.min_quality, Range{0.0, 1.0}, "",
          "share of cells on the plane below which there is no ground");
  }
};

struct DensityImageOptions {
  double resolution = 0.5;
  std::string count = "layers";
  double layer_height = 0.5;
  double min_density = 0.05;
  double saturation = 1.0;
  double max_extent = 256.0;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("resolution", self.resolution, Range{0.05, 10.0}, "m", "edge of a pixel");
    field("count", self.count, Choices{"layers", "points"}, "",
          "what a pixel counts: layers of height that hold points, or points, as the paper does");
    field("layer_height", self.layer_height, Range{0.05, 10.0}, "m",
          "of a layer; 32 layers are told apart");
    field("min_density", self.min_density, Range{0.0, 0.9}, "",
          "relative density below which a pixel is empty, against moving objects");
    field("saturation", self.saturation, Range{0.5, 1.0}, "",
          "quantile of the occupied cells that is shown full, where points are counted and one "
          "tower would dim the rest; 1 is the greatest count");
    field("max_extent", self.max_extent, Range{10.0, 1000.0}, "m",
          "points farther than this from the map's origin along x or y are left out");
  }
};

struct FeatureOptions {
  int max_features = 1000;
  int fast_threshold = 25;
  int edge_px = 31;
  int patch_px = 31;
  int border_px = 31;
  bool pruning = true;
  int pruning_bits = 35;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("max_features", self.max_features, Range{1, 10000}, "",
          "strongest corners kept (the published system: 500; dense maps of 64 beams have more)");
    field("fast_threshold", self.fast_threshold, Range{1, 254}, "",
          "grey-level difference of a corner (the published system: 35)");
    field("edge_px", self.edge_px, Range{0, 200}, "px", "margin of the image without corners");
    field("border_px", self.border_px, Range{0, 200}, "px",
          "empty border put around the image first, so that structure at its rim has features");
    field("patch_px", self.patch_px, Range{9, 63}, "px", "patch a descriptor is computed from");
    field("pruning", self.pruning, OnOff{}, "",
          "self-similarity pruning against repetitive structure");
    field("pruning_bits", self.pruning_bits, Range{0, 255}, "bits",
          "a feature this near to another of its image goes");
  }
};

struct MatchingOptions {
  std::string method = "forest";
  int trees = 16;
  int max_references = 500;
  int max_distance_bits = 50;
  int leaf_size = 100;
  double max_imbalance = 0.5;
  bool nearest_only = false;
  int skipped_maps = 3;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("method", self.method, Choices{"forest", "tree", "exhaustive"}, "",
          "how stored descriptors are searched; tree is the paper's");
    field("max_distance_bits", self.max_distance_bits, Range{0, 256}, "bits",
          "descriptors farther apart do not match");
    field("trees", self.trees, Range{1, 64}, "", "trees of the forest, each on bits of its own");
    field("max_references", self.max_references, Range{1, 1000000}, "",
          "maps of a large database, those with the most matches, that consensus is sought with");
    field("leaf_size", self.leaf_size, Range{2, 10000}, "",
          "descriptors a leaf of the tree holds before it is split");
    field("max_imbalance", self.max_imbalance, Range{0.0, 0.5}, "",
          "a leaf is split only on a bit whose mean is this near to one half (the published tree: "
          "0.1)");
    field("nearest_only", self.nearest_only, OnOff{}, "",
          "of a feature's matches in one map the nearest alone, as the published tree has it");
    field("skipped_maps", self.skipped_maps, Range{0, 1000}, "",
          "maps just before the query that are no candidates");
  }
};

struct ConsensusOptions {
  std::string method = "voting";
  double inlier_radius = 1.5;
  int min_inliers = 3;
  double miss_probability = 1e-3;
  int trials = 0;
  int seed = 0;
  int max_matches = 400;
  bool unique_keypoints = true;
  bool refinement = true;
  double orientation_gate_deg = 12.0;
  int guided_bits = 55;
  double guided_radius = 1.0;

  template <typename Self, typename Visitor>
  static void visit(Self& self, Visitor&& field) {
    field("method", self.method, Choices{"voting", "ransac"}, "",
          "voting tries every match as anchor and needs no luck; ransac is the paper's");
    field("inlier_radius", self.inlier_radius, Range{0.1, 100.0}, "m",
          "distance within which a match agrees with the alignment");
    field("min_inliers", self.min_inliers, Range{2, 1000}, "",
          "candidates with fewer are not reported");
    field("miss_probability", self.miss_probability, Range{1e-9, 0.5}, "",
          "ransac: bound on the probability of missing six inliers");
    field(
        "trials", self.trials, Range{0, 1000000}, "",
        "ransac: trials, as in the paper a fixed number; 0: as many as miss_probability asks for");
    field("seed", self.seed, Range{0, 1000000}, "", "ransac: of the pairs that are tried");
    field("max_matches", self.max_matches, Range{0, 1000000}, "",
          "the nearest matches of a pair of maps that are looked at; 0: all, as in the paper");
    field("unique_keypoints", self.unique_keypoints, OnOff{}, "",
          "a keypoint counts in one inlier; off: in as many as match it, as in the paper");
    field(
        "refinement", self.refinement, OnOff{}, "",
        "fit and count again while that finds more; off: one fit to the best set, as in the paper");
    field("orientation_gate_deg", self.orientation_gate_deg, Range{1.0, 180.0}, "deg",
          "inliers turn with the alignment to within this; 180 leaves orientations out");
    field("guided_bits", self.guided_bits, Range{0, 256}, "bits",
          "keypoints that meet under the alignment count where their descriptors are this near; 0 "
          "counts tentative matches only, as the paper does");
    field("guided_radius", self.guided_radius, Range{0.1, 100.0}, "m",
          "distance within which keypoints meet");
  }
};

struct LoopClosureOptions {
  GroundAlignmentOptions ground_alignment;
  DensityImageOptions density_image;
  FeatureOptions features;
  MatchingOptions matching;
  ConsensusOptions consensus;

  /// Calls section(name, options) for each part.
  template <typename Self, typename Visitor>
  static void visit_sections(Self& self, Visitor&& section) {
    section("ground_alignment", self.ground_alignment);
    section("density_image", self.density_image);
    section("features", self.features);
    section("matching", self.matching);
    section("consensus", self.consensus);
  }
};

}  // namespace groundloop
