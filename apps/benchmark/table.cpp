#include "apps/benchmark/table.hpp"

#include <algorithm>
#include <cstdio>

#include "frontend/core/files.hpp"

namespace groundloop::apps {
namespace {

std::string fixed(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", decimals, value);
  return text;
}

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string latex_text(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '%':
      case '&':
      case '_':
      case '#':
      case '$':
      case '{':
      case '}':
        safe += std::string("\\") + c;
        break;
      case '~':
        safe += "\\textasciitilde{}";
        break;
      case '^':
        safe += "\\textasciicircum{}";
        break;
      case '\\':
        safe += "\\textbackslash{}";
        break;
      case '<':
        safe += "\\textless{}";
        break;
      case '>':
        safe += "\\textgreater{}";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

// A column of words shows what stands in its cells, be it nothing.
std::string cell_text(const TableColumn& column, const TableCell& cell) {
  return column.figures ? to_text(cell) : cell.text;
}

std::string latex_cell(const TableColumn& column, const TableCell& cell) {
  if (!cell.value) return latex_text(cell_text(column, cell));
  std::string text = fixed(*cell.value, cell.decimals);
  if (cell.best) text = "\\textbf{" + text + "}";
  if (cell.error) text += " $\\pm$ " + fixed(*cell.error, cell.decimals);
  return text;
}

// Runs of neighbouring columns with the same heading above.
struct Span {
  std::string above;
  std::size_t first, count;
};
std::vector<Span> spans(const Table& table) {
  std::vector<Span> found;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const std::string& above = table.columns[c].above;
    if (!found.empty() && found.back().above == above) {
      ++found.back().count;
    } else {
      found.push_back({above, c, 1});
    }
  }
  return found;
}

bool has_spans(const Table& table) {
  return std::any_of(table.columns.begin(), table.columns.end(),
                     [](const TableColumn& c) { return !c.above.empty(); });
}

}  // namespace

std::string to_text(const TableCell& cell) {
  if (!cell.value) return cell.text.empty() ? "-" : cell.text;
  std::string text = fixed(*cell.value, cell.decimals);
  if (cell.error) text += " ± " + fixed(*cell.error, cell.decimals);
  return text;
}

std::string to_markdown(const Table& table) {
  std::string text = "## " + table.title + "\n\n|";
  for (const TableColumn& column : table.columns) {
    text += " " + (column.above.empty() ? "" : column.above + ": ") + column.heading + " |";
  }
  text += "\n|";
  for (const TableColumn& column : table.columns) text += column.figures ? " ---: |" : " --- |";
  text += "\n";
  for (const std::vector<TableCell>& row : table.rows) {
    text += "|";
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string content = cell_text(table.columns[c], row[c]);
      text += " " + (row[c].best ? "**" + content + "**" : content) + " |";
    }
    text += "\n";
  }
  text += "\n";
  for (const std::string& note : table.notes) text += "- " + note + "\n";
  return text;
}

std::string to_csv(const Table& table) {
  std::string text;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const TableColumn& column = table.columns[c];
    const std::string name = column.above.empty() ? column.name : column.above + ": " + column.name;
    text += (c == 0 ? "" : ",") + csv_text(name);
    if (column.figures) text += "," + csv_text(name + "_error");
  }
  text += "\n";
  for (const std::vector<TableCell>& row : table.rows) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (c > 0) text += ",";
      if (!table.columns[c].figures) {
        text += csv_text(row[c].text);
        continue;
      }
      text += row[c].value ? groundloop::to_text(*row[c].value) : "";
      text += ",";
      text += row[c].error ? groundloop::to_text(*row[c].error) : "";
    }
    text += "\n";
  }
  return text;
}

std::string to_latex(const Table& table) {
  std::string text =
      "% needs booktabs\n\\begin{table*}\n\\caption{" + latex_text(table.title) + ".";
  for (const std::string& note : table.notes) text += " " + latex_text(note) + ".";
  text += "}\n\\centering\n\\begin{tabular}{";
  for (const TableColumn& column : table.columns) text += column.figures ? 'r' : 'l';
  text += "}\n\\toprule\n";
  if (has_spans(table)) {
    for (const Span& span : spans(table)) {
      text += (span.first == 0 ? "" : " & ") + std::string("\\multicolumn{") +
              std::to_string(span.count) + "}{c}{" + latex_text(span.above) + "}";
    }
    text += " \\\\\n";
    for (const Span& span : spans(table)) {
      if (span.above.empty()) continue;
      text += "\\cmidrule(lr){" + std::to_string(span.first + 1) + "-" +
              std::to_string(span.first + span.count) + "}";
    }
    text += "\n";
  }
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    text += (c == 0 ? "" : " & ") + latex_text(table.columns[c].heading);
  }
  text += " \\\\\n\\midrule\n";
  for (const std::vector<TableCell>& row : table.rows) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      text += (c == 0 ? "" : " & ") + latex_cell(table.columns[c], row[c]);
    }
    text += " \\\\\n";
  }
  return text + "\\bottomrule\n\\end{tabular}\n\\end{table*}\n";
}

}  // namespace groundloop::apps
