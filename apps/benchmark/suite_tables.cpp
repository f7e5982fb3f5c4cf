#include "apps/benchmark/suite_tables.hpp"

#include <algorithm>
#include <cmath>

#include "apps/benchmark/measures.hpp"

namespace groundloop::apps {
namespace {

// What makes a row: a group, or with by_recording one recording of it, and what was run on it.
struct Row {
  std::string group, subject, configuration, detector, references;
  std::vector<const Result*> results;
  friend bool operator==(const Row& a, const Row& b) {
    return a.group == b.group && a.subject == b.subject && a.configuration == b.configuration &&
           a.detector == b.detector && a.references == b.references;
  }
  [[nodiscard]] std::string method() const { return detector.empty() ? configuration : detector; }
  [[nodiscard]] std::string place() const {
    return (subject.empty() ? group : subject) +
           (references == "icp" ? " (references by ICP)" : "");
  }
};

bool fits(const Result& r, const TableKind& kind, const SuiteTable& wanted) {
  if (r.kind != kind.subject) return false;
  if (!kind.detectors && (!r.detector.empty() || r.references != "truth")) return false;
  return fits_any(r.group, wanted.groups) &&
         fits_any(r.detector.empty() ? r.configuration : r.detector, wanted.configurations);
}

// Place of the first pattern that a name fits: the order that is wanted.
std::size_t order_of(const std::string& name, const std::vector<std::string>& patterns) {
  for (std::size_t i = 0; i < patterns.size(); ++i) {
    if (fits_any(name, {patterns[i]})) return i;
  }
  return patterns.size();
}

void add_to(std::vector<Row>& rows, Row key, const Result& result) {
  auto row = std::find(rows.begin(), rows.end(), key);
  if (row == rows.end()) row = rows.insert(rows.end(), std::move(key));
  row->results.push_back(&result);
}

std::vector<Row> rows_of(const Results& results, const TableKind& kind, const SuiteTable& wanted) {
  std::vector<Row> rows;
  for (const Result& r : results.results) {
    if (!fits(r, kind, wanted)) continue;
    add_to(rows, {r.group, "", r.configuration, r.detector, r.references, {}}, r);
    if (wanted.by_recording) {
      add_to(rows, {r.group, r.subject, r.configuration, r.detector, r.references, {}}, r);
    }
  }
  // Groups in the order wanted, else as they came; within each the methods.
  std::vector<std::string> came;
  for (const Row& row : rows) {
    if (std::find(came.begin(), came.end(), row.group) == came.end()) came.push_back(row.group);
  }
  const auto key = [&](const Row& row) {
    const auto place = std::find(came.begin(), came.end(), row.group) - came.begin();
    return std::tuple(order_of(row.group, wanted.groups), place, row.references != "truth",
                      row.subject, order_of(row.method(), wanted.configurations));
  };
  std::stable_sort(rows.begin(), rows.end(),
                   [&](const Row& a, const Row& b) { return key(a) < key(b); });
  return rows;
}

std::vector<const Measure*> columns_of(const TableKind& kind, const SuiteTable& wanted) {
  std::vector<const Measure*> columns;
  for (const std::string& name : wanted.columns.empty() ? kind.columns : wanted.columns) {
    columns.push_back(find_measure(name));
  }
  return columns;
}

TableCell cell_of(const Measure& measure, const Row& row) {
  const Combined combined = combine(measure, row.results);
  return {"", combined.value, combined.error, measure.decimals, false};
}

TableCell text_cell(std::string text) { return {std::move(text), {}, {}, 0, false}; }

// Marks the best figures of a column among rows of the same place.
void mark_best(std::vector<TableCell*> cells, int better) {
  if (better == 0 || cells.size() < 2) return;
  std::optional<double> best;
  for (const TableCell* cell : cells) {
    if (cell->value && (!best || better * (*cell->value - *best) > 0)) best = cell->value;
  }
  for (TableCell* cell : cells) cell->best = cell->value && *cell->value == *best;
}

std::vector<std::string> notes_of(const TableKind& kind,
                                  const std::vector<const Measure*>& columns) {
  std::vector<std::string> notes;
  if (!kind.note.empty()) notes.push_back(kind.note);
  for (const Measure* m : columns) {
    const std::string note = m->heading + ": " + m->definition;
    if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  }
  notes.push_back(
      "± standard error over the recordings of a row (jackknife); n: recordings and repetitions");
  return notes;
}

Table groups_down(const TableKind& kind, const std::vector<Row>& rows,
                  const std::vector<const Measure*>& columns) {
  Table table;
  table.columns = {{kind.subject == "pair" ? "pairs" : "recordings", "group", "", false},
                   {"configuration", "configuration", "", false},
                   {"n", "n", "", true}};
  for (const Measure* m : columns) table.columns.push_back({m->heading, m->name, "", true});
  for (const Row& row : rows) {
    std::vector<TableCell> cells{text_cell(row.place()),
                                 text_cell(row.method()),
                                 {"", static_cast<double>(row.results.size()), {}, 0, false}};
    for (const Measure* m : columns) cells.push_back(cell_of(*m, row));
    table.rows.push_back(std::move(cells));
  }
  for (std::size_t begin = 0; begin < rows.size();) {
    std::size_t end = begin;
    while (end < rows.size() && rows[end].place() == rows[begin].place()) ++end;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      std::vector<TableCell*> cells;
      for (std::size_t r = begin; r < end; ++r) cells.push_back(&table.rows[r][c + 3]);
      mark_best(std::move(cells), columns[c]->better);
    }
    begin = end;
  }
  return table;
}

Table groups_across(const std::vector<Row>& rows, const std::vector<const Measure*>& columns) {
  std::vector<std::string> places, methods;
  for (const Row& row : rows) {
    if (std::find(places.begin(), places.end(), row.place()) == places.end()) {
      places.push_back(row.place());
    }
    if (std::find(methods.begin(), methods.end(), row.method()) == methods.end()) {
      methods.push_back(row.method());
    }
  }
  Table table;
  table.columns = {{"configuration", "configuration", "", false}};
  for (const std::string& place : places) {
    for (const Measure* m : columns) table.columns.push_back({m->heading, m->name, place, true});
  }
  for (const std::string& method : methods) {
    std::vector<TableCell> cells{text_cell(method)};
    for (const std::string& place : places) {
      const auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) {
        return r.place() == place && r.method() == method;
      });
      for (const Measure* m : columns) {
        cells.push_back(row == rows.end() ? text_cell("-") : cell_of(*m, *row));
      }
    }
    table.rows.push_back(std::move(cells));
  }
  for (std::size_t c = 1; c < table.columns.size(); ++c) {
    std::vector<TableCell*> cells;
    for (std::vector<TableCell>& row : table.rows) cells.push_back(&row[c]);
    mark_best(std::move(cells), columns[(c - 1) % columns.size()]->better);
  }
  return table;
}

Table compare_kind(const TableKind& kind, const Results& before, const Results& after) {
  SuiteTable all;
  all.kind = kind.name;
  Table table;
  table.title = kind.title;
  table.columns = {{"row", "group", "", false},
                   {"configuration", "configuration", "", false},
                   {"measure", "measure", "", false},
                   {"n", "n", "", true},
                   {"before", "before", "", true},
                   {"after", "after", "", true},
                   {"difference", "difference", "", true},
                   {"", "verdict", "", false}};
  const std::vector<Row> old_rows = rows_of(before, kind, all);
  for (const Row& row : rows_of(after, kind, all)) {
    const auto old_row = std::find(old_rows.begin(), old_rows.end(), row);
    if (old_row == old_rows.end()) continue;
    for (const Measure* m : columns_of(kind, all)) {
      const TableCell a = cell_of(*m, *old_row), b = cell_of(*m, row);
      const Combined difference = combine_difference(*m, old_row->results, row.results);
      if (!a.value && !b.value) continue;
      // Where there is one recording its figures are what they are: any change is one.
      const bool beyond =
          difference.value && std::abs(*difference.value) > 2 * difference.error.value_or(0.0);
      const double gain = m->better * difference.value.value_or(0.0);
      const char* verdict = !a.value || !b.value     ? "in one only"
                            : !beyond || gain == 0.0 ? ""
                            : gain > 0               ? "better"
                                                     : "worse";
      table.rows.push_back({text_cell(row.place()),
                            text_cell(row.method()),
                            text_cell(m->heading),
                            {"", static_cast<double>(difference.results), {}, 0, false},
                            a,
                            b,
                            {"", difference.value, difference.error, m->decimals, false},
                            text_cell(verdict)});
    }
  }
  table.notes = {
      "difference: after less before, over the recordings that both have, ± its standard error "
      "(jackknife over them)",
      "better, worse: by more than twice that error; of a single recording any difference"};
  return table;
}

}  // namespace

Table make_table(const SuiteTable& wanted, const Results& results) {
  const TableKind& kind = *find_table_kind(wanted.kind);
  const std::vector<Row> rows = rows_of(results, kind, wanted);
  const std::vector<const Measure*> columns = columns_of(kind, wanted);
  Table table =
      wanted.groups_across ? groups_across(rows, columns) : groups_down(kind, rows, columns);
  table.title = wanted.title;
  table.notes = notes_of(kind, columns);
  return table;
}

std::vector<Table> compare_results(const Results& before, const Results& after) {
  std::vector<Table> tables;
  for (const TableKind& kind : table_kinds()) {
    Table table = compare_kind(kind, before, after);
    if (!table.rows.empty()) tables.push_back(std::move(table));
  }
  return tables;
}

}  // namespace groundloop::apps
