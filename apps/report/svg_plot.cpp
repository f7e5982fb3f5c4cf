#include "apps/report/svg_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace groundloop::apps {
namespace {

constexpr double kWidth = 900.0;
constexpr double kLeft = 64.0;
constexpr double kRight = 16.0;
constexpr double kTop = 12.0;
constexpr double kBottom = 46.0;

std::string number(double value, int decimals) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

struct Axis {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] double span() const { return high - low; }
  // Some room on both sides, and a range where there is none.
  void widen() {
    if (!(low <= high)) low = 0.0, high = 1.0;
    const double margin = span() > 0.0 ? 0.04 * span() : 0.5;
    low -= margin;
    high += margin;
  }
};

struct Frame {
  Axis x, y;
  double height = 300.0;  // of the drawing area

  [[nodiscard]] double px(double v) const {
    return kLeft + (v - x.low) / x.span() * (kWidth - kLeft - kRight);
  }
  [[nodiscard]] double py(double v) const { return kTop + (y.high - v) / y.span() * height; }
};

bool finite(const std::pair<double, double>& p) {
  return std::isfinite(p.first) && std::isfinite(p.second);
}

Frame frame_of(const Plot& plot) {
  Frame frame;
  const auto include = [&](const std::pair<double, double>& p) {
    if (!finite(p)) return;
    frame.x.include(p.first);
    frame.y.include(p.second);
  };
  for (const PlotSeries& series : plot.series) {
    for (const auto& point : series.points) include(point);
  }
  for (const PlotLink& link : plot.links) {
    include(link.from);
    include(link.to);
  }
  if (plot.y_from_zero) frame.y.include(0.0);
  frame.x.widen();
  frame.y.widen();
  if (plot.y_from_zero && frame.y.low < 0.0) frame.y.low = 0.0;
  if (plot.equal_axes) {
    const double width = kWidth - kLeft - kRight;
    const double wanted = frame.y.span() / frame.x.span() * width;
    frame.height = std::clamp(wanted, 240.0, 760.0);
    // The axis that is short of room keeps its range; the other shows more.
    Axis& other = wanted > frame.height ? frame.x : frame.y;
    const double span = wanted > frame.height ? frame.y.span() * width / frame.height
                                              : frame.x.span() * frame.height / width;
    const double extra = std::max(0.0, 0.5 * (span - other.span()));
    other.low -= extra;
    other.high += extra;
  }
  return frame;
}

// A step of 1, 2 or 5 times a power of ten, about `count` in the span.
double tick_step(double span, double count) {
  const double raw = span / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (raw <= factor * power) return factor * power;
  }
  return 10.0 * power;
}

std::string grid(const Frame& frame, const Plot& plot) {
  std::string svg;
  const auto decimals = [](double step) {
    return std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  };
  const auto line = [&](double x1, double y1, double x2, double y2) {
    svg += "<line class=\"grid\" x1=\"" + number(x1, 1) + "\" y1=\"" + number(y1, 1) + "\" x2=\"" +
           number(x2, 1) + "\" y2=\"" + number(y2, 1) + "\"/>";
  };
  const auto text = [&](double x, double y, const char* anchor, const std::string& value) {
    svg += "<text x=\"" + number(x, 1) + "\" y=\"" + number(y, 1) + "\" text-anchor=\"" + anchor +
           "\">" + value + "</text>";
  };
  const double bottom = kTop + frame.height;
  const double x_step = tick_step(frame.x.span(), 9.0);
  for (double v = std::ceil(frame.x.low / x_step) * x_step; v <= frame.x.high; v += x_step) {
    line(frame.px(v), kTop, frame.px(v), bottom);
    text(frame.px(v), bottom + 16.0, "middle", number(v + 0.0, decimals(x_step)));
  }
  const double y_step = plot.equal_axes ? x_step : tick_step(frame.y.span(), 6.0);
  for (double v = std::ceil(frame.y.low / y_step) * y_step; v <= frame.y.high; v += y_step) {
    line(kLeft, frame.py(v), kWidth - kRight, frame.py(v));
    text(kLeft - 6.0, frame.py(v) + 4.0, "end", number(v + 0.0, decimals(y_step)));
  }
  text(0.5 * (kLeft + kWidth), bottom + 36.0, "middle", escape_html(plot.x_label));
  const std::string middle = number(kTop + 0.5 * frame.height, 1);
  svg += "<text transform=\"rotate(-90 14 " + middle + ")\" x=\"14\" y=\"" + middle +
         "\" text-anchor=\"middle\">" + escape_html(plot.y_label) + "</text>";
  return svg;
}

std::string draw(const PlotSeries& series, const Frame& frame) {
  // Steps below half a pixel are invisible.
  std::string points;
  std::string dots;
  double last_x = -1e9;
  double last_y = -1e9;
  for (std::size_t i = 0; i < series.points.size(); ++i) {
    if (!finite(series.points[i])) continue;
    const double x = frame.px(series.points[i].first);
    const double y = frame.py(series.points[i].second);
    if (i + 1 < series.points.size() && std::hypot(x - last_x, y - last_y) < 0.5) continue;
    last_x = x;
    last_y = y;
    if (series.dots) {
      dots += "<circle class=\"" + series.style + "\" cx=\"" + number(x, 1) + "\" cy=\"" +
              number(y, 1) + "\" r=\"3\"/>";
    } else {
      points += number(x, 1) + "," + number(y, 1) + " ";
    }
  }
  if (series.dots) return dots;
  return "<polyline class=\"" + series.style + "\" points=\"" + points + "\"/>";
}

std::string draw(const PlotLink& link, const Frame& frame) {
  if (!finite(link.from) || !finite(link.to)) return {};
  const std::string x1 = number(frame.px(link.from.first), 1);
  const std::string y1 = number(frame.py(link.from.second), 1);
  return "<g class=\"" + link.style + "\"><title>" + escape_html(link.text) +
         "</title><line x1=\"" + x1 + "\" y1=\"" + y1 + "\" x2=\"" +
         number(frame.px(link.to.first), 1) + "\" y2=\"" + number(frame.py(link.to.second), 1) +
         "\"/><circle cx=\"" + x1 + "\" cy=\"" + y1 + "\" r=\"3\"/></g>";
}

}  // namespace

std::string to_svg(const Plot& plot) {
  const Frame frame = frame_of(plot);
  const std::string height = number(kTop + frame.height + kBottom, 0);
  std::string html = "<figure><figcaption>" + escape_html(plot.title);
  for (const PlotSeries& series : plot.series) {
    if (series.label.empty()) continue;
    html += " <span class=\"key\"><svg width=\"24\" height=\"8\"><polyline class=\"" +
            series.style + "\" points=\"0,4 24,4\"/></svg>" + escape_html(series.label) + "</span>";
  }
  html += "</figcaption><svg class=\"plot\" role=\"img\" viewBox=\"0 0 " + number(kWidth, 0) + " " +
          height + "\">" + grid(frame, plot);
  for (const PlotSeries& series : plot.series) html += draw(series, frame);
  for (const PlotLink& link : plot.links) html += draw(link, frame);
  return html + "</svg></figure>\n";
}

std::string escape_html(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

}  // namespace groundloop::apps
