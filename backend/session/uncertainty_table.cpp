#include "backend/session/uncertainty_table.hpp"

#include <array>
#include <string_view>

#include "backend/session/table_row.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop {
namespace {

constexpr std::array<const char*, 6> kNames{"tx", "ty", "tz", "rx", "ry", "rz"};

}  // namespace

std::string covariance_header() {
  std::string text;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = i; j < 6; ++j)
      text += std::string(text.empty() ? "" : ",") + "cov_" + kNames.at(i) + "_" + kNames.at(j);
  }
  return text;
}

void append_covariance(std::string& text, const Matrix6d& covariance) {
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) text += "," + to_text(covariance(i, j));
  }
}

void write_uncertainty(const std::filesystem::path& file, const std::vector<Matrix6d>& of_maps) {
  std::string text = "map," + covariance_header() + "\n";
  for (std::size_t m = 0; m < of_maps.size(); ++m) {
    text += std::to_string(m);
    append_covariance(text, of_maps[m]);
    text += '\n';
  }
  write_text_atomically(file, text);
}

std::vector<Matrix6d> read_uncertainty(const std::filesystem::path& file) {
  const std::string text = read_text(file);
  const std::string header = "map," + covariance_header() + "\n";
  if (!text.starts_with(header))
    throw InputError(file.string() + ":1: the header is not that of a groundloop table");
  std::vector<Matrix6d> of_maps;
  std::string_view rest = std::string_view(text).substr(header.size());
  for (std::size_t line = 2; !rest.empty(); ++line) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const TableRow row(file, line, rest.substr(0, end));
    row.expect_fields(22);
    if (row.integer<std::size_t>(0) != of_maps.size()) row.fail("maps are not numbered in order");
    Matrix6d covariance;
    std::size_t field = 1;
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) covariance(i, j) = covariance(j, i) = row.number(field++);
    }
    of_maps.push_back(covariance);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return of_maps;
}

}  // namespace groundloop
