#include "frontend/core/pcd.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <string>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop {
namespace {

static_assert(sizeof(Eigen::Vector3f) == 12, "points are written as they lie in memory");

std::string header(std::size_t count) {
  const std::string n = std::to_string(count);
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE "
         "F F F\nCOUNT 1 1 1\nWIDTH " +
         n + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA binary\n";
}

}  // namespace

void write_pcd(const std::filesystem::path& file, const Points& points) {
  OutputFile out(file);
  out.write(header(points.size()));
  out.write(points.data(), points.size() * sizeof(Eigen::Vector3f));
  out.commit();
}

Points read_pcd(const std::filesystem::path& file) {
  const std::vector<std::byte> bytes = read_file(file);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t points_at = text.find("\nPOINTS ");
  const std::string_view data_line = "\nDATA binary\n";
  const std::size_t data_at = text.find(data_line);
  std::size_t count = 0;
  if (points_at != std::string_view::npos && data_at != std::string_view::npos) {
    std::from_chars(text.data() + points_at + 8, text.data() + data_at, count);
  }
  if (data_at == std::string_view::npos ||
      text.substr(0, data_at).find("\nFIELDS x y z\n") == std::string_view::npos ||
      (bytes.size() - data_at - data_line.size()) / sizeof(Eigen::Vector3f) != count ||
      text.substr(0, data_at + data_line.size()) != header(count)) {
    throw InputError(file.string() +
                     ": is no local map of groundloop, or is cut off; run the session again");
  }
  Points points(count);
  const std::byte* source = bytes.data() + data_at + data_line.size();
  if (count > 0) std::memcpy(points.front().data(), source, count * sizeof(Eigen::Vector3f));
  const auto broken = std::find_if_not(points.begin(), points.end(),
                                       [](const Eigen::Vector3f& p) { return p.allFinite(); });
  if (broken != points.end()) {
    throw InputError(file.string() + ": point " + std::to_string(broken - points.begin()) +
                     " is no number; run the session again");
  }
  return points;
}

}  // namespace groundloop
