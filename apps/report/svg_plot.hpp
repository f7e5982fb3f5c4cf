// Line plots as inline SVG, coloured by the page's style sheet, for the report.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace groundloop::apps {

struct PlotSeries {
  std::string label;  ///< in the legend; empty: not there
  std::string style;  ///< class of the style sheet, e.g. "truth"
  std::vector<std::pair<double, double>> points;
  bool dots = false;  ///< markers instead of a line
};

/// A straight line between two points with a text shown under the pointer.
struct PlotLink {
  std::string style;
  std::pair<double, double> from, to;
  std::string text;
};

struct Plot {
  std::string title;
  std::string x_label, y_label;
  bool equal_axes = false;
  bool y_from_zero = false;
  std::vector<PlotSeries> series;
  std::vector<PlotLink> links;
};

/// One <figure> with one <svg>. Points that are not finite are left out; long lines are thinned to
/// what the eye can tell apart.
[[nodiscard]] std::string to_svg(const Plot& plot);

/// Text made safe inside HTML.
[[nodiscard]] std::string escape_html(const std::string& text);

}  // namespace groundloop::apps
