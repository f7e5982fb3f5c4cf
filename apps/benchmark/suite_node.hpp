// One entry of a suite's YAML: checks its keys, names file and line where something is wrong, and
// writes out `for: {word: [values]}` as one entry for each combination.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "frontend/core/error.hpp"

namespace groundloop::apps {

using Words = std::map<std::string, std::string>;

/// Replaces {word} by its value; what is in braces and no word stays.
[[nodiscard]] std::string with_words(const std::string& text, const Words& words);

class SuiteNode {
 public:
  SuiteNode(YAML::Node node, std::string file, Words words = {});

  /// Throws InputError naming the first key that is none of these, with the nearest of them.
  void expect_keys(const std::vector<std::string>& keys) const;
  [[nodiscard]] bool has(const std::string& key) const;
  [[nodiscard]] std::string text(const std::string& key, const std::string& otherwise = "") const;
  /// Throws InputError where the key is missing or empty.
  [[nodiscard]] std::string required(const std::string& key) const;
  [[nodiscard]] bool flag(const std::string& key, bool otherwise) const;
  [[nodiscard]] int number(const std::string& key, int otherwise) const;
  /// A list of texts, or one text.
  [[nodiscard]] std::vector<std::string> texts(const std::string& key) const;
  /// A map as KEY=VALUE; one level of sections is joined by a dot.
  [[nodiscard]] std::vector<std::string> settings(const std::string& key) const;
  /// The entries of a list, each written out for every combination of its `for`.
  [[nodiscard]] std::vector<SuiteNode> entries(const std::string& key) const;
  /// The words of its `for` as "seed=1 sensor=spin32"; empty where it has none.
  [[nodiscard]] std::string word_text() const;

  [[noreturn]] void fail(const std::string& what) const;

 private:
  [[nodiscard]] std::vector<SuiteNode> written_out() const;
  [[nodiscard]] std::string scalar(const YAML::Node& node, const std::string& key) const;
  void add_settings(const YAML::Node& node, const std::string& prefix,
                    std::vector<std::string>& settings) const;

  YAML::Node node_;
  std::string file_;
  Words words_;
};

}  // namespace groundloop::apps
