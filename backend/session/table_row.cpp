#include "backend/session/table_row.hpp"

#include <algorithm>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"

namespace groundloop {

TableRow::TableRow(const std::filesystem::path& file, std::size_t line, std::string_view text)
    : file_(file), line_(line) {
  std::string field;
  bool in_quotes = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_quotes) {
      if (c != '"') {
        field += c;
      } else if (i + 1 < text.size() && text[i + 1] == '"') {
        field += '"';
        ++i;
      } else {
        in_quotes = false;
      }
    } else if (c == '"') {
      in_quotes = true;
    } else if (c == ',') {
      fields_.push_back(std::move(field));
      field.clear();
    } else if (c != '\r') {
      field += c;
    }
  }
  fields_.push_back(std::move(field));
}

void TableRow::expect_fields(std::size_t n) const {
  if (fields_.size() != n)
    fail(std::to_string(fields_.size()) + " fields, expected " + std::to_string(n));
}

double TableRow::number(std::size_t i) const {
  double value = 0.0;
  if (!parse_double(fields_[i], value)) fail("'" + fields_[i] + "' is no finite number");
  return value;
}

std::optional<double> TableRow::optional_number(std::size_t i) const {
  if (fields_[i].empty()) return std::nullopt;
  return number(i);
}

Pose TableRow::pose(std::size_t i) const {
  const Eigen::Quaterniond q(number(i + 6), number(i + 3), number(i + 4), number(i + 5));
  if (std::abs(q.norm() - 1.0) > 1e-3)
    fail("the quaternion has norm " + to_text(q.norm()) + ", expected 1");
  Pose pose;
  pose.rotation = q;  // as it was written, so that a table read and written again is the same
  pose.translation = {number(i), number(i + 1), number(i + 2)};
  return pose;
}

void TableRow::fail(const std::string& what) const {
  throw InputError(file_.string() + ":" + std::to_string(line_) + ": " + what +
                   "; run the session again");
}

void for_each_row(const std::filesystem::path& file, std::string_view text,
                  std::size_t lines_before, const std::function<void(const TableRow&)>& f) {
  std::string_view rest = text;
  for (std::size_t line = 1; !rest.empty(); ++line) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view row = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line > lines_before && !row.empty()) f(TableRow(file, line, row));
  }
}

void append_pose(std::string& text, const Pose& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  for (const double v : {pose.translation.x(), pose.translation.y(), pose.translation.z(), q.x(),
                         q.y(), q.z(), q.w()}) {
    text += "," + to_text(v);
  }
}

std::string quoted(const std::string& name) {
  if (name.find_first_of(",\"\n") == std::string::npos) return name;
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"') text += '"';
    text += c;
  }
  return text + "\"";
}

}  // namespace groundloop
