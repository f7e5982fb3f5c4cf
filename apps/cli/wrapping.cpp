#include "apps/cli/wrapping.hpp"

#include <algorithm>

namespace groundloop::apps {

std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) >> 6) != 2; }));
}

std::vector<std::string> wrapped(std::string_view text, std::size_t width) {
  std::vector<std::string> lines(1);
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string_view word = text.substr(begin, end - begin);
    begin = end + 1;
    if (word.empty()) continue;
    std::string& line = lines.back();
    if (line.empty()) {
      line = word;
    } else if (columns_of(line) + 1 + columns_of(word) <= width) {
      line += " " + std::string(word);
    } else {
      lines.emplace_back(word);
    }
  }
  return lines;
}

std::string two_columns(std::string_view left, std::string_view right, std::size_t column,
                        std::size_t width) {
  std::string text = "  " + std::string(left);
  if (right.empty()) return text + "\n";
  const std::string indent(column, ' ');
  bool first = true;
  for (const std::string& line : wrapped(right, width > column ? width - column : 1)) {
    const std::size_t used = columns_of(text);
    if (first && used + 2 <= column) {
      text += std::string(column - used, ' ') + line + "\n";
    } else {
      text += (first ? "\n" : "") + indent + line + "\n";
    }
    first = false;
  }
  return text;
}

}  // namespace groundloop::apps
