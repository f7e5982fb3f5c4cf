// A table of figures, and the three forms it is written in: Markdown to read, CSV to go on with,
// LaTeX for papers.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace groundloop::apps {

struct TableCell {
  std::string text;  ///< where it is no figure
  std::optional<double> value;
  std::optional<double> error;  ///< standard error
  int decimals = 3;
  bool best = false;  ///< of those that it is compared with: bold
};

struct TableColumn {
  std::string heading;
  std::string name;   ///< in CSV; its errors go to NAME_error
  std::string above;  ///< heading over neighbouring columns of the same; may be empty
  bool figures = true;
};

struct Table {
  std::string title;
  std::vector<std::string> notes;  ///< definitions of the columns, and what else is to be said
  std::vector<TableColumn> columns;
  std::vector<std::vector<TableCell>> rows;
};

/// "-" where there is no figure.
[[nodiscard]] std::string to_text(const TableCell& cell);

[[nodiscard]] std::string to_markdown(const Table& table);
/// One line a row, figures with all their digits, errors in columns of their own.
[[nodiscard]] std::string to_csv(const Table& table);
/// A table environment with booktabs; definitions in the caption.
[[nodiscard]] std::string to_latex(const Table& table);

}  // namespace groundloop::apps
