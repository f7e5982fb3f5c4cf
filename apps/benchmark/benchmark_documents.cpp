#include "apps/benchmark/benchmark_documents.hpp"

#include <algorithm>
#include <cctype>
#include <ctime>
#include <fstream>
#include <map>
#include <thread>

#include "apps/benchmark/suite_tables.hpp"
#include "apps/report/html_page.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop::apps {
namespace {

namespace fs = std::filesystem;

// Letters, digits and _ of a title.
std::string file_name(const std::string& title) {
  std::string name;
  for (const char c : title) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (plain) {
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  return name;
}

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  std::string line;
  while (std::getline(in, line)) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) {
      return line.substr(colon + 2);
    }
  }
  return "unknown processor";
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof(text), "%Y-%m-%d %H:%M UTC", &utc);
  return text;
}

PageTable for_page(const Table& table) {
  PageTable page{table.title, "", {}, {}};
  for (const std::string& note : table.notes) page.note += (page.note.empty() ? "" : ". ") + note;
  for (const TableColumn& column : table.columns) {
    page.columns.push_back((column.above.empty() ? "" : column.above + ": ") + column.heading);
  }
  for (const std::vector<TableCell>& row : table.rows) {
    std::vector<std::string> cells;
    for (std::size_t c = 0; c < row.size(); ++c) {
      cells.push_back(table.columns[c].figures ? to_text(row[c]) : row[c].text);
    }
    page.rows.push_back(std::move(cells));
  }
  return page;
}

Table gap_table(const Results& results) {
  Table table;
  table.title = "Not there";
  table.columns = {{"what", "what", "", false}, {"why", "why", "", false}};
  for (const Gap& gap : results.gaps) {
    table.rows.push_back({{gap.what, {}, {}, 0, false}, {gap.why, {}, {}, 0, false}});
  }
  return table;
}

// Precision and recall of every row of closures, recordings of a group pooled.
void write_curves(const Results& results, const fs::path& folder) {
  std::map<std::string, std::vector<const Detections*>> rows;
  for (const Result& r : results.results) {
    if (!r.detections) continue;
    const std::string method = r.detector.empty() ? r.configuration : r.detector;
    rows[r.kind + " " + r.group + " " + method + (r.references == "icp" ? " icp" : "")].push_back(
        &*r.detections);
  }
  for (const auto& [name, detections] : rows) {
    std::string text = "score,true_positives,false_positives,precision,recall,f1\n";
    for (const groundloop::PrecisionRecallPoint& p :
         pooled_curve(detections, Counting::all).curve) {
      text += groundloop::to_text(p.threshold) + "," + std::to_string(p.true_positives) + "," +
              std::to_string(p.false_positives) + "," + groundloop::to_text(p.precision) + "," +
              groundloop::to_text(p.recall) + "," + groundloop::to_text(p.f1) + "\n";
    }
    write_text_atomically(folder / (file_name(name) + ".csv"), text);
  }
}

}  // namespace

std::vector<std::pair<std::string, std::string>> made_by(const std::string& command_line) {
  return {
      {"groundloop", GROUNDLOOP_VERSION},
      {"compiler", __VERSION__},
      {"machine", std::to_string(std::thread::hardware_concurrency()) + " cores of " + processor()},
      {"date", today()},
      {"command", command_line}};
}

void write_benchmark_documents(const Suite& suite, const Results& results, const fs::path& out) {
  write_results(out / "results.json", results);
  for (const char* folder : {"tables", "curves"}) {
    fs::remove_all(out / folder);
    fs::create_directories(out / folder);
  }
  write_curves(results, out / "curves");
  std::string text = "# " + results.title + "\n\n";
  for (const auto& [key, value] : results.made) text += "- " + key + ": " + value + "\n";
  Page page;
  page.title = results.title;
  page.figures = results.made;
  std::vector<Table> tables;
  for (const SuiteTable& wanted : suite.tables) {
    Table table = make_table(wanted, results);
    if (!table.rows.empty()) tables.push_back(std::move(table));
  }
  if (!results.gaps.empty()) tables.push_back(gap_table(results));
  for (std::size_t t = 0; t < tables.size(); ++t) {
    const std::string number = (t + 1 < 10 ? "0" : "") + std::to_string(t + 1);
    const fs::path file = out / "tables" / (number + "_" + file_name(tables[t].title));
    text += "\n" + to_markdown(tables[t]);
    write_text_atomically(file.string() + ".md", to_markdown(tables[t]));
    write_text_atomically(file.string() + ".csv", to_csv(tables[t]));
    write_text_atomically(file.string() + ".tex", to_latex(tables[t]));
    page.tables.push_back(for_page(tables[t]));
  }
  write_text_atomically(out / "report.md", text);
  write_text_atomically(out / "report.html", make_page(std::move(page)));
}

}  // namespace groundloop::apps
