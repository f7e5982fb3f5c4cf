// Rows of a session's comma-separated tables: reading with errors that name file, line and field,
// and the fields that several tables share.
#pragma once

#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "frontend/core/pose.hpp"

namespace groundloop {

class TableRow {
 public:
  /// Splits `text` at commas; fields in quotes may hold commas and doubled quotes.
  TableRow(const std::filesystem::path& file, std::size_t line, std::string_view text);

  void expect_fields(std::size_t n) const;
  [[nodiscard]] std::size_t size() const { return fields_.size(); }
  [[nodiscard]] const std::string& text(std::size_t i) const { return fields_[i]; }
  template <typename T>
  [[nodiscard]] T integer(std::size_t i) const {
    T value{};
    const std::string& f = fields_[i];
    const auto result = std::from_chars(f.data(), f.data() + f.size(), value);
    if (result.ec != std::errc() || result.ptr != f.data() + f.size())
      fail("'" + f + "' is no whole number");
    return value;
  }
  [[nodiscard]] double number(std::size_t i) const;
  [[nodiscard]] std::optional<double> optional_number(std::size_t i) const;
  /// tx ty tz qx qy qz qw from field `i` on.
  [[nodiscard]] Pose pose(std::size_t i) const;
  [[noreturn]] void fail(const std::string& what) const;

 private:
  const std::filesystem::path& file_;
  std::size_t line_;
  std::vector<std::string> fields_;
};

/// Calls `f` for every line of `text` after `lines_before` that is not empty.
void for_each_row(const std::filesystem::path& file, std::string_view text,
                  std::size_t lines_before, const std::function<void(const TableRow&)>& f);

/// Appends ",tx,ty,tz,qx,qy,qz,qw", each so that it reads back the same.
void append_pose(std::string& text, const Pose& pose);
/// A name as a field: quoted where it holds a comma or a quote.
[[nodiscard]] std::string quoted(const std::string& name);

}  // namespace groundloop
