#include "loopclosure/features.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>
#include <new>

#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>

#include "loopclosure/hamming.hpp"

namespace groundloop {
namespace {

struct Detection {
  std::vector<cv::KeyPoint> keypoints;  // in pixels of the image without border
  cv::Mat descriptors;                  // one row a keypoint
};

Detection detect(const DensityImage& image, const FeatureOptions& options) {
  // OpenCV's threads are of no use here: maps are described in parallel.
  static std::once_flag once;
  std::call_once(once, [] { cv::setNumThreads(1); });
  // OpenCV does not write to its input.
  cv::Mat bordered(image.height, image.width, CV_8UC1,
                   const_cast<std::uint8_t*>(image.pixels.data()));
  const int b = std::max(0, options.border_px);
  if (b > 0) {
    const cv::Mat view = bordered;
    bordered = cv::Mat::zeros(image.height + 2 * b, image.width + 2 * b, CV_8UC1);
    view.copyTo(bordered(cv::Rect(b, b, image.width, image.height)));
  }
  Detection result;
  const auto orb = cv::ORB::create(options.max_features, 1.2F, 1, options.edge_px, 0, 2,
                                   cv::ORB::HARRIS_SCORE, options.patch_px, options.fast_threshold);
  orb->detectAndCompute(bordered, cv::noArray(), result.keypoints, result.descriptors);
  for (cv::KeyPoint& keypoint : result.keypoints) {
    keypoint.pt -= cv::Point2f(static_cast<float>(b), static_cast<float>(b));
  }
  return result;
}

// OpenCV has an error of its own for memory that ran out; all the rest knows one.
Detection detect_or_bad_alloc(const DensityImage& image, const FeatureOptions& options) {
  try {
    return detect(image, options);
  } catch (const cv::Exception& e) {
    if (e.code == cv::Error::StsNoMem) throw std::bad_alloc();
    throw;
  }
}

}  // namespace

std::vector<bool> self_similarity_keep(const std::vector<Descriptor>& descriptors, int bits) {
  const std::size_t n = descriptors.size();
  std::vector<bool> keep(n, true);
  std::vector<std::uint16_t> distances(n);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const std::size_t rest = n - i - 1;
    hamming_distances(descriptors[i], descriptors.data() + i + 1, rest, distances.data());
    for (std::size_t k = 0; k < rest; ++k) {
      if (distances[k] <= bits) keep[i] = keep[i + 1 + k] = false;
    }
  }
  return keep;
}

Features extract_features(const DensityImage& image, const FeatureOptions& options) {
  Features result;
  if (image.width <= 0 || image.height <= 0) return result;
  const auto [keypoints, bytes] = detect_or_bad_alloc(image, options);
  if (keypoints.empty()) return result;
  std::vector<Descriptor> descriptors(keypoints.size());
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    std::memcpy(descriptors[i].data(), bytes.ptr(static_cast<int>(i)), sizeof(Descriptor));
  }
  const std::vector<bool> keep = options.pruning
                                     ? self_similarity_keep(descriptors, options.pruning_bits)
                                     : std::vector<bool>(descriptors.size(), true);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    if (!keep[i]) continue;
    // Rows grow along y, so OpenCV's angle from columns to rows is that from x to y.
    result.keypoints.push_back(image.to_metres(keypoints[i].pt.x, keypoints[i].pt.y));
    result.orientations.push_back(keypoints[i].angle * static_cast<float>(M_PI / 180.0));
    result.descriptors.push_back(descriptors[i]);
  }
  return result;
}

}  // namespace groundloop
