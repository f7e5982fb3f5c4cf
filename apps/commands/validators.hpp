// What CLI11 has no words for.
#pragma once

#include <algorithm>
#include <string>

#include <CLI/CLI.hpp>

namespace groundloop::apps {

/// A count: digits alone. CLI11 would take -5 for a very large number.
inline CLI::Validator whole_number() {
  return {[](const std::string& text) {
            const bool digits =
                std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
            return digits && text.size() < 19 ? std::string()
                                              : "'" + text + "' is no whole number from 0 on";
          },
          ""};
}

}  // namespace groundloop::apps
