// ORB features of a density image and self-similarity pruning (Sec. 3.4). OpenCV computes corners
// and descriptors on one thread, so that the same image always gives the same features.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "loopclosure/density_image.hpp"
#include "loopclosure/loop_closure.hpp"
#include "loopclosure/options.hpp"

namespace groundloop {

struct Features {
  std::vector<Eigen::Vector2f> keypoints;  ///< metres, in the ground frame
  std::vector<float> orientations;         ///< rad, in the ground frame
  std::vector<Descriptor> descriptors;
};

/// Features of `image` after pruning; none where the image is empty or smaller than a patch.
[[nodiscard]] Features extract_features(const DensityImage& image, const FeatureOptions& options);

/// Marks the descriptors to keep: those whose nearest other descriptor is farther than `bits`. A
/// single descriptor has no other and stays.
[[nodiscard]] std::vector<bool> self_similarity_keep(const std::vector<Descriptor>& descriptors,
                                                     int bits);

}  // namespace groundloop
