// Options as plain structs that describe themselves once; reading, writing, validating and
// documenting follow from that.
//
// A struct of options has a default, a unit and a reason on every line and lists its fields for a
// visitor:
//
//   struct LocalMapOptions {
//     double length = 100.0;
//     template <typename Self, typename Visitor>
//     static void visit(Self& self, Visitor&& field) {
//       field("length", self.length, Range{1.0, 1e4}, "m", "displacement that ends a local map");
//     }
//   };
//
// Field types: double, int, bool, std::string (with the list of allowed values).
#pragma once

#include <cmath>
#include <initializer_list>
#include <sstream>
#include <string>
#include <vector>

#include "frontend/core/error.hpp"

namespace groundloop {

struct Range {
  double min;
  double max;
};
/// Allowed values of a text option.
using Choices = std::vector<std::string>;
/// Stands where the range of a bool would.
struct OnOff {};

namespace detail {

struct Validator {
  std::string section;

  template <typename T>
  void operator()(const char* key, const T& value, const Range& range, const char* unit,
                  const char*) const {
    const auto v = static_cast<double>(value);
    if (std::isfinite(v) && v >= range.min && v <= range.max) return;
    std::ostringstream text;
    text << section << "." << key << ": " << v << " is out of range; allowed are " << range.min
         << " to " << range.max;
    if (*unit != '\0') text << " " << unit;
    throw InputError(text.str());
  }
  void operator()(const char*, const bool&, const OnOff&, const char*, const char*) const {}
  void operator()(const char* key, const std::string& value, const Choices& choices, const char*,
                  const char*) const {
    std::string list;
    for (const std::string& choice : choices) {
      if (choice == value) return;
      list += (list.empty() ? "" : ", ") + choice;
    }
    throw InputError(section + "." + key + ": '" + value + "' is unknown; allowed are " + list);
  }
};

}  // namespace detail

/// Throws InputError naming the key, the value and the allowed range of the first field that is out
/// of it.
template <typename Options>
void validate(const Options& options, const std::string& section) {
  Options::visit(options, detail::Validator{section});
}

}  // namespace groundloop
