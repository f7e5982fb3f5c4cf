#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>

#include <fnmatch.h>

#include "apps/benchmark/measures.hpp"
#include "apps/benchmark/suite.hpp"
#include "apps/benchmark/suite_node.hpp"
#include "apps/benchmark/suites.hpp"
#include "frontend/core/files.hpp"

namespace groundloop::apps {
namespace {

namespace fs = std::filesystem;

// Names become names of folders.
std::string file_name(const SuiteNode& node, const std::string& name) {
  const bool bad = std::any_of(name.begin(), name.end(), [](char c) {
    return c == '/' || c == '~' || static_cast<unsigned char>(c) < ' ';
  });
  if (bad || name.empty() || name[0] == '.') {
    node.fail("the name '" + name + "' must be one that a folder can have, without '/' and '~'");
  }
  return name;
}

void add_recordings(const SuiteNode& root, Suite& suite) {
  for (const SuiteNode& node : root.entries("recordings")) {
    node.expect_keys({"name", "group", "path", "format", "topic", "ground_truth", "truth_frame",
                      "options", "needs", "references", "memory_mb", "for"});
    SuiteRecording r;
    r.name = file_name(node, node.required("name"));
    r.group = node.text("group", r.name);
    r.path = node.required("path");
    r.format = node.text("format");
    r.topic = node.text("topic");
    r.ground_truth = node.text("ground_truth");
    r.truth_frame = node.text("truth_frame");
    r.options = node.texts("options");
    r.needs = node.texts("needs");
    r.references = node.texts("references");
    if (r.references.empty()) r.references = {"truth"};
    for (const std::string& poses : r.references) {
      if (poses != "truth" && poses != "icp") {
        node.fail("'references': '" + poses + "' is neither truth nor icp");
      }
    }
    r.memory_mb = node.number("memory_mb", r.memory_mb);
    suite.recordings.push_back(std::move(r));
  }
}

void add_pairs(const SuiteNode& root, Suite& suite) {
  for (const SuiteNode& node : root.entries("pairs")) {
    node.expect_keys({"name", "group", "reference", "query", "overlap", "merge", "for"});
    SuitePair p;
    p.reference = node.required("reference");
    p.query = node.required("query");
    p.name = file_name(node, node.text("name", p.reference + "+" + p.query));
    p.group = node.text("group", p.name);
    p.overlap = node.flag("overlap", p.overlap);
    p.merge = node.flag("merge", p.merge);
    for (const std::string& name : {p.reference, p.query}) {
      if (std::none_of(suite.recordings.begin(), suite.recordings.end(),
                       [&](const SuiteRecording& r) { return r.name == name; })) {
        node.fail("no recording is called '" + name + "'");
      }
    }
    suite.pairs.push_back(std::move(p));
  }
}

void add_configurations(const SuiteNode& root, Suite& suite) {
  for (const SuiteNode& node : root.entries("configurations")) {
    node.expect_keys({"name", "preset", "set", "groups", "for"});
    suite.configurations.push_back({file_name(node, node.required("name")), node.word_text(),
                                    node.text("preset"), node.settings("set"),
                                    node.texts("groups")});
  }
  if (suite.configurations.empty()) suite.configurations.push_back({"default", "", "", {}, {}});
}

void add_detectors(const SuiteNode& root, Suite& suite) {
  for (const SuiteNode& node : root.entries("detectors")) {
    node.expect_keys(
        {"name", "command", "pair_command", "preset", "set", "configurations", "groups", "for"});
    SuiteDetector d;
    d.name = file_name(node, node.required("name"));
    d.repetition = node.word_text();
    d.command = node.texts("command");
    d.pair_command = node.texts("pair_command");
    d.preset = node.text("preset");
    d.settings = node.settings("set");
    d.configurations = node.texts("configurations");
    d.groups = node.texts("groups");
    if (!d.own() && !(d.preset.empty() && d.settings.empty())) {
      node.fail("a detector has a command, or a preset and settings of groundloop's own");
    }
    suite.detectors.push_back(std::move(d));
  }
}

void add_tables(const SuiteNode& root, Suite& suite) {
  for (const SuiteNode& node : root.entries("tables")) {
    node.expect_keys({"title", "kind", "columns", "groups", "configurations", "groups_across",
                      "by_recording", "for"});
    SuiteTable t;
    t.kind = node.required("kind");
    const TableKind* kind = find_table_kind(t.kind);
    if (kind == nullptr) {
      std::string names;
      for (const TableKind& k : table_kinds()) names += (names.empty() ? "" : ", ") + k.name;
      node.fail("no kind of table is called '" + t.kind + "'; there are " + names);
    }
    t.title = node.text("title", kind->title);
    t.columns = node.texts("columns");
    for (const std::string& column : t.columns) {
      if (find_measure(column) == nullptr) {
        node.fail("no measure is called '" + column + "'; did you mean '" +
                  nearest_measure(column) + "'?");
      }
    }
    t.groups = node.texts("groups");
    t.configurations = node.texts("configurations");
    t.groups_across = node.flag("groups_across", t.groups_across);
    t.by_recording = node.flag("by_recording", t.by_recording);
    suite.tables.push_back(std::move(t));
  }
}

// Text of a suite and the name to call it by in messages.
std::pair<std::string, std::string> suite_text(const std::string& file_or_name,
                                               const fs::path& folder) {
  const fs::path beside = folder / file_or_name;
  if (fs::is_regular_file(beside)) return {read_text(beside), beside.string()};
  for (const Preset& suite : kSuites) {
    if (file_or_name == suite.name || file_or_name == std::string(suite.name) + ".yaml") {
      return {suite.yaml, file_or_name};
    }
  }
  std::string names;
  for (const std::string& name : suite_names()) names += (names.empty() ? "" : ", ") + name;
  throw InputError(file_or_name + ": no such file, nor a suite (" + names + ")");
}

void read_into(const std::string& file_or_name, const fs::path& folder, bool included, int depth,
               Suite& suite) {
  const auto [text, place] = suite_text(file_or_name, folder);
  try {
    const SuiteNode root(YAML::Load(text), place);
    root.expect_keys(
        {"title", "include", "recordings", "pairs", "configurations", "detectors", "tables"});
    if (depth > 8) root.fail("suites include each other without an end");
    if (!included) suite.title = root.text("title", fs::path(place).stem().string());
    for (const std::string& other : root.texts("include")) {
      read_into(other, fs::path(place).parent_path(), true, depth + 1, suite);
    }
    add_recordings(root, suite);
    add_pairs(root, suite);
    if (included) return;  // of another suite only what it is about
    add_configurations(root, suite);
    add_detectors(root, suite);
    add_tables(root, suite);
  } catch (const YAML::Exception& e) {
    throw InputError(place + ":" + std::to_string(e.mark.line + 1) + ": no valid YAML: " + e.msg);
  }
}

template <typename Entries>
void expect_different(const std::string& place, const char* what, const Entries& entries) {
  std::set<std::string> names;
  for (const auto& entry : entries) {
    std::string name = entry.name;
    if constexpr (requires { entry.repetition; }) name += "~" + entry.repetition;
    if (!names.insert(name).second) {
      throw InputError(place + ": two " + what + " are called '" + entry.name +
                       "'; names tell results apart");
    }
  }
}

}  // namespace

Suite read_suite(const std::string& file_or_name) {
  Suite suite;
  suite.file = file_or_name;
  read_into(file_or_name, "", false, 0, suite);
  if (suite.recordings.empty()) throw InputError(file_or_name + ": names no recordings");
  expect_different(file_or_name, "recordings", suite.recordings);
  expect_different(file_or_name, "pairs", suite.pairs);
  expect_different(file_or_name, "configurations", suite.configurations);
  expect_different(file_or_name, "detectors", suite.detectors);
  if (suite.tables.empty()) {
    for (const TableKind& kind : table_kinds()) {
      SuiteTable table;
      table.title = kind.title;
      table.kind = kind.name;
      suite.tables.push_back(std::move(table));
    }
  }
  return suite;
}

std::vector<std::string> suite_names() {
  std::vector<std::string> names;
  for (const Preset& suite : kSuites) names.emplace_back(suite.name);
  return names;
}

bool fits_any(const std::string& name, const std::vector<std::string>& patterns) {
  return patterns.empty() || std::any_of(patterns.begin(), patterns.end(), [&](const auto& p) {
           return fnmatch(p.c_str(), name.c_str(), 0) == 0;
         });
}

}  // namespace groundloop::apps
