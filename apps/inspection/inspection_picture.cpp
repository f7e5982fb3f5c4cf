#include "apps/inspection/inspection_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/inspection/scan_rasters.hpp"
#include "apps/report/grey_picture.hpp"

namespace groundloop::apps {
namespace {

constexpr int kMargin = 16, kSide = 800, kWide = 1000, kTitle = 40, kCaption = 28;
constexpr double kInk = 20, kPaper = 255, kFrame = 170;

std::string text(const char* format, double a, double b = 0.0) {
  std::array<char, 120> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, a, b);
  return buffer.data();
}

void write(cv::Mat& page, const std::string& line, cv::Point at, double size = 0.5) {
  std::string plain;  // OpenCV draws ASCII alone
  for (const char c : line) plain += static_cast<unsigned char>(c) < 128 ? c : '?';
  cv::putText(page, plain, at, cv::FONT_HERSHEY_SIMPLEX, size, cv::Scalar(kInk), 1, cv::LINE_AA);
}

// A raster's values from `low` (dark) to `high` (light grey), cells without any white.
void paint(cv::Mat& page, const cv::Rect& frame, const Raster& raster, double low, double high) {
  cv::Mat cells(static_cast<int>(raster.height), static_cast<int>(raster.width), CV_8U);
  for (std::size_t row = 0; row < raster.height; ++row) {
    for (std::size_t column = 0; column < raster.width; ++column) {
      const auto value = static_cast<double>(raster.at(column, row));
      const double share = high == low ? 0.0 : std::clamp((value - low) / (high - low), 0.0, 1.0);
      cells.at<std::uint8_t>(static_cast<int>(row), static_cast<int>(column)) =
          std::isnan(value) ? std::uint8_t{255} : static_cast<std::uint8_t>(210.0 * share);
    }
  }
  cv::Mat inside = page(frame);
  cv::resize(cells, inside, frame.size(), 0, 0, cv::INTER_NEAREST);
  cv::rectangle(page, frame, cv::Scalar(kFrame));
}

// The value that a share of a raster's cells are below.
double level(const Raster& raster, double share) {
  std::vector<float> values;
  for (const float value : raster.values)
    if (!std::isnan(value)) values.push_back(value);
  if (values.empty()) return 0.0;
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return static_cast<double>(values[static_cast<std::size_t>(rank)]);
}

// Dots from left to right, from `low` at the bottom to `high` at the top.
void plot(cv::Mat& page, const cv::Rect& frame, const std::vector<double>& values, double low,
          double high) {
  cv::rectangle(page, frame, cv::Scalar(kFrame));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double across = (static_cast<double>(i) + 0.5) / static_cast<double>(values.size());
    const double up = std::clamp((values[i] - low) / std::max(high - low, 1e-9), 0.0, 1.0);
    const cv::Point at(frame.x + static_cast<int>(across * frame.width),
                       frame.y + frame.height - 1 - static_cast<int>(up * (frame.height - 2)));
    cv::circle(page, at, 1, cv::Scalar(kInk), cv::FILLED);
  }
}

}  // namespace

std::vector<std::byte> draw_inspection(const Inspection& inspection,
                                       const std::vector<double>& intervals) {
  const Scan& scan = inspection.example;
  const int right = kSide + 2 * kMargin;
  cv::Mat page(kTitle + kSide + kCaption + 2 * kMargin, right + kWide + kMargin, CV_8U,
               cv::Scalar(kPaper));
  write(page,
        inspection.info.path + ": " + inspection.info.format + ", " +
            std::to_string(inspection.scans) + " scans; scan " +
            std::to_string(inspection.example_index) + " with " +
            std::to_string(scan.points.size()) + " points",
        {kMargin, kTitle - 12}, 0.6);

  const double half = usual_reach(scan);
  const Raster above = seen_from_above(scan, kSide / 2, kSide / 2, half);
  paint(page, {kMargin, kTitle, kSide, kSide}, above, level(above, 0.95), level(above, 0.05));
  cv::drawMarker(page, {kMargin + kSide / 2, kTitle + kSide / 2}, cv::Scalar(kInk),
                 cv::MARKER_CROSS, 12);
  write(page, text("from above, forward is up, %.0f m to each side; dark is high", half),
        {kMargin, kTitle + kSide + 20});

  const View view = view_of(scan);
  const Raster ranges = range_image(scan, kWide / 2, 120, view);
  const cv::Rect image(right, kTitle, kWide, 360);
  paint(page, image, ranges, 0.0, level(ranges, 0.95));
  write(page,
        text("range: dark is near, light %.0f m; ", level(ranges, 0.95)) +
            text("azimuth %.0f to %.0f, ", view.left_deg, view.right_deg) +
            text("elevation %.0f to %.0f degrees", view.top_deg, view.bottom_deg),
        {right, image.br().y + 20});

  const cv::Rect first(right, image.br().y + kCaption + 8, kWide, 180);
  const std::vector<double> along = times_along(scan, kWide);
  if (along.empty()) {
    plot(page, first, {}, 0.0, 1.0);
    write(page, "points have no times: " + inspection.info.point_times.substr(0, 90),
          {right, first.br().y + 20});
  } else {
    const auto [least, most] = std::minmax_element(along.begin(), along.end());
    plot(page, first, along, *least, *most);
    write(page,
          text("times of points in the order of the recording: %+.4f to %+.4f s from the stamp",
               *least, *most),
          {right, first.br().y + 20});
  }
  const cv::Rect second(right, first.br().y + kCaption + 8, kWide,
                        kTitle + kSide - first.br().y - kCaption - 8);
  const double longest =
      intervals.empty() ? 1.0 : *std::max_element(intervals.begin(), intervals.end());
  plot(page, second, intervals, 0.0, longest);
  write(page,
        intervals.empty() ? std::string("one scan: no intervals")
                          : text("time from scan to scan: up to %.3f s; %.4g Hz", longest,
                                 inspection.timing.rate_hz),
        {right, second.br().y + 20});

  GreyPicture picture{page.cols, page.rows, {}};
  picture.pixels.assign(page.datastart, page.dataend);
  return to_png(picture);
}

}  // namespace groundloop::apps
