#include "apps/report/html_page.hpp"

#include <regex>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace groundloop::apps {
namespace {

// Every element that is opened is closed, in order; an attribute never breaks out of its quotes.
void expect_well_formed(const std::string& html) {
  const std::set<std::string> empty{"meta", "img", "link", "!doctype"};
  std::vector<std::string> open;
  const std::regex tag(R"(<(/?)([!a-zA-Z0-9]+)((?:[^<>"]|"[^"]*")*)>)");
  for (std::sregex_iterator it(html.begin(), html.end(), tag), end; it != end; ++it) {
    const std::string name = (*it)[2];
    if (empty.contains(name) || (*it)[3].str().ends_with("/")) continue;
    if ((*it)[1].length() == 0) {
      open.push_back(name);
    } else {
      ASSERT_FALSE(open.empty());
      ASSERT_EQ(open.back(), name) << it->position();
      open.pop_back();
    }
  }
  EXPECT_TRUE(open.empty());
}

Page filled() {
  Page page;
  page.title = "run <of> a \"town\" & back";
  page.verdict = make_verdict({{Trust::careful, "a gap"}, {Trust::untrusted, "lost <here>"}});
  page.figures = {{"path", "3 & 4 m"}};
  page.pictures = {{"a \"frame\"", "data:image/png;base64,AAAA"}};
  page.tables = {{"Figures", "of <it>", {"", "a < b"}, {{"mean", "1 & 2"}}}};
  return page;
}

TEST(HtmlPage, IsWellFormedAndEscapesWhatItIsGiven) {
  const std::string html = make_page(filled());
  expect_well_formed(html);
  for (const char* text : {"run &lt;of&gt; a &quot;town&quot; &amp; back", "3 &amp; 4 m",
                           "lost &lt;here&gt;", "a &lt; b", "a &quot;frame&quot;"}) {
    EXPECT_NE(html.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(html.find("<script"), std::string::npos);  // nothing for scripts to draw
}

TEST(HtmlPage, SaysFirstWhatIsNotToBeTrusted) {
  const std::string html = make_page(filled());
  const std::size_t verdict = html.find("not to be trusted");
  ASSERT_NE(verdict, std::string::npos);
  EXPECT_LT(verdict, html.find("3 &amp; 4 m"));
  EXPECT_LT(html.find("lost &lt;here&gt;"), html.find("a gap"));  // the worst first
}

TEST(HtmlPage, ForbidsEveryRequest) {
  for (const bool scripts : {false, true}) {
    Page page = filled();
    if (scripts) page.json["plots"] = nlohmann::ordered_json::array();
    const std::string html = make_page(std::move(page));
    EXPECT_NE(html.find("Content-Security-Policy\" content=\"default-src 'none'"),
              std::string::npos);
    for (const char* outside : {"src=\"http", "href=\"http", "@import", "url(http"}) {
      EXPECT_EQ(html.find(outside), std::string::npos) << outside;
    }
  }
}

TEST(HtmlPage, PutsThePointsOfAPlotInTheOrderOfX) {
  PagePlot plot{"t", "", "x", "y", true, {{"s", "after", {3, 1, 2}, {30, 10, 20}}}};
  const auto json = to_json(plot);
  EXPECT_EQ(json["series"][0]["x"].dump(), "[1.0,2.0,3.0]");
  EXPECT_EQ(json["series"][0]["y"].dump(), "[10.0,20.0,30.0]");
}

TEST(Verdict, IsTheWorstOfItsRemarks) {
  EXPECT_EQ(make_verdict({}).trust, Trust::good);
  EXPECT_EQ(make_verdict({{Trust::careful, "a"}}).trust, Trust::careful);
  const Verdict verdict =
      make_verdict({{Trust::careful, "a"}, {Trust::untrusted, "b"}, {Trust::careful, "c"}});
  EXPECT_EQ(verdict.trust, Trust::untrusted);
  ASSERT_EQ(verdict.remarks.size(), 3U);
  EXPECT_EQ(verdict.remarks.front().text, "b");
  EXPECT_EQ(verdict.remarks.back().text, "c");
}

}  // namespace
}  // namespace groundloop::apps
