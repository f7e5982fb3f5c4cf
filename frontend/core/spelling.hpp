// What somebody may have meant: the nearest known word to an unknown one.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace groundloop {

/// Letters to insert, remove or exchange to come from a to b (Levenshtein).
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The nearest of the known words (a container of strings), the first of equal ones.
template <typename Words>
[[nodiscard]] std::string nearest_word(std::string_view word, const Words& known) {
  std::string nearest;
  std::size_t best = static_cast<std::size_t>(-1);
  for (const auto& candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance >= best) continue;
    best = distance;
    nearest = candidate;
  }
  return nearest;
}

/// "; did you mean 'word'?", or nothing where even the nearest word differs by more than half.
template <typename Words>
[[nodiscard]] std::string suggestion(std::string_view word, const Words& known) {
  const std::string nearest = nearest_word(word, known);
  if (nearest.empty() || edit_distance(word, nearest) > word.size() / 2) return {};
  return "; did you mean '" + nearest + "'?";
}

}  // namespace groundloop
