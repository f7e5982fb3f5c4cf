#include "apps/benchmark/suite_node.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "frontend/core/spelling.hpp"

namespace groundloop::apps {

std::string with_words(const std::string& text, const Words& words) {
  std::string result;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t open = text.find('{', at);
    const std::size_t close = open == std::string::npos ? open : text.find('}', open);
    if (close == std::string::npos) break;
    const auto word = words.find(text.substr(open + 1, close - open - 1));
    result += text.substr(at, open - at);
    result += word == words.end() ? text.substr(open, close + 1 - open) : word->second;
    at = close + 1;
  }
  return result + text.substr(at);
}

SuiteNode::SuiteNode(YAML::Node node, std::string file, Words words)
    : node_(std::move(node)), file_(std::move(file)), words_(std::move(words)) {}

void SuiteNode::fail(const std::string& what) const {
  throw InputError(file_ + ":" + std::to_string(node_.Mark().line + 1) + ": " + what);
}

void SuiteNode::expect_keys(const std::vector<std::string>& keys) const {
  if (!node_.IsMap()) fail("expected 'key: value' lines");
  for (const auto& entry : node_) {
    const auto key = entry.first.as<std::string>();
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    SuiteNode(entry.first, file_)
        .fail("unknown key '" + key + "'; did you mean '" + nearest_word(key, keys) + "'?");
  }
}

bool SuiteNode::has(const std::string& key) const {
  return node_.IsMap() && node_[key].IsDefined() && !node_[key].IsNull();
}

std::string SuiteNode::scalar(const YAML::Node& node, const std::string& key) const {
  if (!node.IsScalar()) SuiteNode(node, file_).fail("'" + key + "' wants one value");
  return with_words(node.as<std::string>(), words_);
}

std::string SuiteNode::text(const std::string& key, const std::string& otherwise) const {
  return has(key) ? scalar(node_[key], key) : with_words(otherwise, words_);
}

std::string SuiteNode::required(const std::string& key) const {
  std::string value = text(key);
  if (value.empty()) fail("'" + key + "' is missing");
  return value;
}

bool SuiteNode::flag(const std::string& key, bool otherwise) const {
  if (!has(key)) return otherwise;
  const std::string value = text(key);
  if (value == "true" || value == "yes" || value == "on") return true;
  if (value != "false" && value != "no" && value != "off") {
    fail("'" + key + "': '" + value + "' is neither true nor false");
  }
  return false;
}

int SuiteNode::number(const std::string& key, int otherwise) const {
  if (!has(key)) return otherwise;
  const std::string value = text(key);
  int result = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), result);
  if (error != std::errc() || end != value.data() + value.size()) {
    fail("'" + key + "': '" + value + "' is no whole number");
  }
  return result;
}

std::vector<std::string> SuiteNode::texts(const std::string& key) const {
  std::vector<std::string> result;
  if (!has(key)) return result;
  if (node_[key].IsScalar()) return {text(key)};
  if (!node_[key].IsSequence()) fail("'" + key + "' wants a list");
  for (const auto& element : node_[key]) result.push_back(scalar(element, key));
  return result;
}

void SuiteNode::add_settings(const YAML::Node& node, const std::string& prefix,
                             std::vector<std::string>& settings) const {
  for (const auto& entry : node) {
    const std::string key = prefix + entry.first.as<std::string>();
    if (entry.second.IsMap()) {
      add_settings(entry.second, key + ".", settings);
    } else {
      settings.push_back(key + "=" + scalar(entry.second, key));
    }
  }
}

std::vector<std::string> SuiteNode::settings(const std::string& key) const {
  std::vector<std::string> result;
  if (!has(key)) return result;
  if (!node_[key].IsMap()) fail("'" + key + "' wants 'section.key: value' lines");
  add_settings(node_[key], "", result);
  return result;
}

std::vector<SuiteNode> SuiteNode::entries(const std::string& key) const {
  std::vector<SuiteNode> result;
  if (!has(key)) return result;
  if (!node_[key].IsSequence()) fail("'" + key + "' wants a list");
  for (const auto& element : node_[key]) {
    const std::vector<SuiteNode> written = SuiteNode(element, file_, words_).written_out();
    result.insert(result.end(), written.begin(), written.end());
  }
  return result;
}

std::vector<SuiteNode> SuiteNode::written_out() const {
  std::vector<SuiteNode> result{*this};
  if (!has("for")) return result;
  if (!node_["for"].IsMap()) fail("'for' wants 'word: [values]'");
  for (const auto& entry : node_["for"]) {
    const auto word = entry.first.as<std::string>();
    std::vector<SuiteNode> longer;
    for (const SuiteNode& node : result) {
      const std::vector<std::string> values =
          SuiteNode(node_["for"], file_, node.words_).texts(word);
      if (values.empty()) fail("'for': no values for '" + word + "'");
      for (const std::string& value : values) {
        longer.push_back(node);
        longer.back().words_[word] = value;
      }
    }
    result = std::move(longer);
  }
  return result;
}

std::string SuiteNode::word_text() const {
  std::string result;
  if (!has("for")) return result;
  for (const auto& entry : node_["for"]) {
    const auto word = entry.first.as<std::string>();
    result += (result.empty() ? "" : " ") + word + "=" + words_.at(word);
  }
  return result;
}

}  // namespace groundloop::apps
