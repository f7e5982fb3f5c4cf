// The page around a report's document: one file that needs nothing else and asks for nothing from
// anywhere (its content security policy forbids it). What matters stands in plain HTML, so that it
// is read first, printed, and there without scripts; the scripts in page/ draw the rest.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/report/blobs.hpp"
#include "apps/report/verdict.hpp"

namespace groundloop::apps {

/// Text made safe inside HTML.
[[nodiscard]] std::string escape_html(std::string_view text);

/// A picture of the map from above as it stands in the page before any script has run.
struct PagePicture {
  std::string caption;
  std::string data_uri;
};

struct PageTable {
  std::string title;
  std::string note;  ///< under the title
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};

/// A plot of lines, drawn by the scripts.
struct PagePlot {
  struct Series {
    std::string name;
    std::string style;  ///< "after", "before" or "truth"
    std::vector<double> x, y;
  };
  std::string title, note;
  std::string x, y;        ///< what the axes show, with units
  bool from_zero = false;  ///< the y axis
  std::vector<Series> series;
  bool plan = false;  ///< places from above: both axes alike, points in their own order
};
/// An element of the array `plots` in a page's JSON; points are put in the order of x.
[[nodiscard]] nlohmann::ordered_json to_json(const PagePlot& plot);

/// What is empty is left out.
struct Page {
  std::string title;
  std::optional<Verdict> verdict;
  std::vector<std::pair<std::string, std::string>> figures;  ///< key figures: name and value
  std::vector<PagePicture> pictures;
  std::vector<PageTable> tables;  ///< plain ones, which need no script
  nlohmann::ordered_json json;    ///< what the scripts draw; null: a page without scripts
  Blobs blobs;                    ///< arrays that `json` names
};

/// The whole page.
[[nodiscard]] std::string make_page(Page page);

}  // namespace groundloop::apps
