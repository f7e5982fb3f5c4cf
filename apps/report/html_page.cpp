#include "apps/report/html_page.hpp"

#include <algorithm>
#include <numeric>
#include <span>

namespace groundloop {
// Made by cmake/EmbedFiles.cmake.
std::string_view embedded_page_script();
std::string_view embedded_page_style();
std::string_view embedded_page_licences();
std::string_view embedded_library_d3();
std::string_view embedded_library_three();
}  // namespace groundloop

namespace groundloop::apps {
namespace {

std::string tag(const char* name, const std::string& text) {
  return std::string("<") + name + ">" + escape_html(text) + "</" + name + ">";
}

std::string head(const std::string& title) {
  return "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
         "script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:\">\n"
         "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
         "<link rel=\"icon\" href=\"data:,\">\n" +
         tag("title", "groundloop: " + title) + "\n<style>\n" + std::string(embedded_page_style()) +
         "</style>\n</head>\n";
}

std::string verdict_html(const Verdict& verdict) {
  std::string html = std::string("<section class=\"verdict ") + to_string(verdict.trust) +
                     "\" aria-label=\"verdict\">\n" + tag("strong", verdict.headline) + "\n";
  if (!verdict.remarks.empty()) {
    html += "<ul>\n";
    for (const Remark& remark : verdict.remarks)
      html += std::string("<li class=\"remark ") + to_string(remark.trust) + "\">" +
              escape_html(remark.text) +
              (remark.advice.empty() ? "" : " <em>Try: " + escape_html(remark.advice) + ".</em>") +
              "</li>\n";
    html += "</ul>\n";
  }
  return html + "</section>\n";
}

std::string figures_html(const Page& page) {
  std::string html = "<dl class=\"figures\">\n";
  for (const auto& [name, value] : page.figures)
    html += "<div>" + tag("dt", name) + tag("dd", value) + "</div>\n";
  return html + "</dl>\n";
}

std::string pictures_html(const Page& page) {
  std::string html = "<div id=\"pictures\" class=\"pictures\">\n";
  for (std::size_t p = 0; p < page.pictures.size(); ++p) {
    const PagePicture& picture = page.pictures[p];
    const std::string caption = escape_html(picture.caption);
    html += "<figure><img id=\"picture-" + std::to_string(p) +
            "\" alt=\"The map from above: " + caption + "\" src=\"" + picture.data_uri + "\">";
    if (page.pictures.size() > 1) html += "<figcaption>" + caption + "</figcaption>";
    html += "</figure>\n";
  }
  return html + "</div>\n";
}

std::string library_html(const char* name, std::string_view packed) {
  return std::string("<script type=\"text/plain\" id=\"library-") + name + "\">" +
         std::string(packed) + "</script>\n";
}

std::string table_html(const PageTable& table) {
  std::string html = "<section>\n" + tag("h2", table.title) + "\n";
  if (!table.note.empty()) html += "<p class=\"note\">" + escape_html(table.note) + "</p>\n";
  html += "<div class=\"wide\"><table>\n";
  if (!table.columns.empty()) {
    html += "<thead><tr>";
    for (const std::string& column : table.columns) html += tag("th", column);
    html += "</tr></thead>\n";
  }
  html += "<tbody>\n";
  for (const std::vector<std::string>& row : table.rows) {
    html += "<tr>";
    for (const std::string& cell : row) html += tag("td", cell);
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n</section>\n";
}

// Libraries, arrays, the document, and what draws it.
std::string scripts_html(Page& page) {
  // Names from outside may not be UTF-8; the page is.
  const std::string json =
      page.json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  const nlohmann::ordered_json reference =
      page.blobs.add(std::span(reinterpret_cast<const std::uint8_t*>(json.data()), json.size()));
  return "<footer><details><summary>Licences</summary><pre>" +
         escape_html(embedded_page_licences()) + "</pre></details></footer>\n" +
         library_html("d3", embedded_library_d3()) +
         (page.json.contains("frames") ? library_html("three", embedded_library_three()) : "") +
         page.blobs.html() + "<script type=\"application/json\" id=\"document\">" +
         reference.dump() + "</script>\n<script>\n\"use strict\";\n(() => {\n" +
         std::string(embedded_page_script()) + "})();\n</script>\n";
}

}  // namespace

std::string escape_html(std::string_view text) {
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

nlohmann::ordered_json to_json(const PagePlot& plot) {
  nlohmann::ordered_json series = nlohmann::ordered_json::array();
  for (const PagePlot::Series& s : plot.series) {
    std::vector<std::size_t> order(s.x.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (!plot.plan)
      std::stable_sort(order.begin(), order.end(),
                       [&](std::size_t a, std::size_t b) { return s.x[a] < s.x[b]; });
    nlohmann::ordered_json x = nlohmann::ordered_json::array();
    nlohmann::ordered_json y = nlohmann::ordered_json::array();
    for (const std::size_t i : order) {
      x.push_back(s.x[i]);
      y.push_back(s.y[i]);
    }
    series.push_back({{"name", s.name}, {"style", s.style}, {"x", x}, {"y", y}});
  }
  return {{"title", plot.title},    {"note", plot.note}, {"x", plot.x},     {"y", plot.y},
          {"zero", plot.from_zero}, {"plan", plot.plan}, {"series", series}};
}

std::string make_page(Page page) {
  std::string html = head(page.title);
  html += "<body>\n<header>\n" + tag("h1", page.title) + "\n";
  if (page.verdict) html += verdict_html(*page.verdict);
  html += figures_html(page) +
          "<nav id=\"contents\" aria-label=\"contents\"></nav>\n</header>\n<main>\n" +
          pictures_html(page);
  for (const PageTable& table : page.tables) html += table_html(table);
  if (!page.json.is_null()) {
    html +=
        "<noscript><p class=\"note\">Plots, tables and the view in three dimensions need "
        "scripts.</p></noscript>\n<div id=\"app\"></div>\n";
  }
  html += "</main>\n";
  if (!page.json.is_null()) html += scripts_html(page);
  return html + "</body>\n</html>\n";
}

}  // namespace groundloop::apps
