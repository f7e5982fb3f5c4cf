#include "apps/inspection/terminal_sketch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace groundloop::apps {

namespace {

std::string text(const char* format, double a, double b = 0.0, double c = 0.0) {
  std::array<char, 160> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, a, b, c);
  return buffer.data();
}

// The character U+2800 + dots in UTF-8.
std::string braille(unsigned dots) {
  return {static_cast<char>(0xe2), static_cast<char>(0xa0U | dots >> 6U),
          static_cast<char>(0x80U | (dots & 0x3fU))};
}

// Cells of two by four points each, as braille has them.
std::string braille_picture(const Raster& raster) {
  constexpr unsigned kDots[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
  std::string picture;
  for (std::size_t row = 0; row + 4 <= raster.height; row += 4) {
    for (std::size_t column = 0; column + 2 <= raster.width; column += 2) {
      unsigned dots = 0;
      for (std::size_t y = 0; y < 4; ++y)
        for (std::size_t x = 0; x < 2; ++x)
          if (!std::isnan(raster.at(column + x, row + y))) dots |= kDots[y][x];
      picture += braille(dots);
    }
    picture += '\n';
  }
  return picture;
}

std::string ascii_picture(const Raster& raster) {
  std::string picture;
  for (std::size_t row = 0; row < raster.height; ++row) {
    for (std::size_t column = 0; column < raster.width; ++column)
      picture += std::isnan(raster.at(column, row)) ? ' ' : '*';
    picture += '\n';
  }
  return picture;
}

std::string from_above(const Scan& scan, const SketchOptions& options) {
  // A character is twice as high as wide.
  const double half = usual_reach(scan);
  const std::size_t columns = std::min<std::size_t>(options.columns, 64), rows = columns / 2;
  const std::string head = text("from above, %.0f m to each side, forward is up:\n", half);
  return head + (options.unicode
                     ? braille_picture(seen_from_above(scan, 2 * columns, 4 * rows, half))
                     : ascii_picture(seen_from_above(scan, columns, rows, half)));
}

std::string ranges(const Scan& scan, const SketchOptions& options) {
  constexpr std::array kShades = {"\u2588", "\u2593", "\u2592", "\u2591"};
  constexpr std::array kLetters = {"@", "+", "-", "."};
  constexpr std::size_t kRows = 16;
  const View view = view_of(scan);
  const Raster raster = range_image(scan, options.columns, kRows, view);
  std::vector<float> sorted;
  for (const float range : raster.values)
    if (!std::isnan(range)) sorted.push_back(range);
  if (sorted.empty()) return {};
  std::sort(sorted.begin(), sorted.end());
  // As many cells of each shade.
  std::array<float, 3> limits{};
  for (std::size_t i = 0; i < 3; ++i) limits[i] = sorted[(i + 1) * (sorted.size() - 1) / 4];
  std::string picture =
      text("range image, %.0f to %.0f degrees from left to right, ", view.left_deg,
           view.right_deg) +
      text("%.0f to %.0f degrees from top to bottom;\n", view.top_deg, view.bottom_deg) +
      text("dark is near: up to %.1f, %.1f, %.1f m and beyond:\n", static_cast<double>(limits[0]),
           static_cast<double>(limits[1]), static_cast<double>(limits[2]));
  for (std::size_t row = 0; row < raster.height; ++row) {
    for (std::size_t column = 0; column < raster.width; ++column) {
      const float range = raster.at(column, row);
      if (std::isnan(range)) {
        picture += ' ';
        continue;
      }
      const auto shade = static_cast<std::size_t>(
          std::count_if(limits.begin(), limits.end(), [&](float limit) { return range > limit; }));
      picture += options.unicode ? kShades[shade] : kLetters[shade];
    }
    picture += '\n';
  }
  return picture;
}

std::string times(const Scan& scan, const SketchOptions& options) {
  constexpr std::array kBars = {"\u2581", "\u2582", "\u2583", "\u2584",
                                "\u2585", "\u2586", "\u2587", "\u2588"};
  const std::vector<double> along = times_along(scan, options.columns);
  if (along.empty()) return {};
  const auto [least, most] = std::minmax_element(along.begin(), along.end());
  std::string picture = text(
      "times of points in the order of the recording, low is early: %+.4f to %+.4f s from the "
      "stamp:\n",
      *least, *most);
  for (const double time : along) {
    const double share = *most > *least ? (time - *least) / (*most - *least) : 0.0;
    const auto level = std::min<std::size_t>(7, static_cast<std::size_t>(8.0 * share));
    picture += options.unicode ? std::string(kBars[level])
                               : std::string(1, static_cast<char>('0' + level));
  }
  return picture + "\n";
}

}  // namespace

std::string sketch_scan(const Scan& scan, const SketchOptions& options) {
  std::string sketch = from_above(scan, options);
  for (const std::string& part : {ranges(scan, options), times(scan, options)}) {
    if (!part.empty()) sketch += "\n" + part;
  }
  return sketch;
}

bool locale_is_unicode() {
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') continue;
    return std::strstr(value, "UTF-8") != nullptr || std::strstr(value, "utf8") != nullptr ||
           std::strstr(value, "UTF8") != nullptr || std::strstr(value, "utf-8") != nullptr;
  }
  return false;
}

}  // namespace groundloop::apps
