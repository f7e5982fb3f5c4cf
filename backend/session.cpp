#include "backend/session.hpp"

#include <array>
#include <charconv>
#include <cstdio>
#include <string_view>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"

namespace groundloop {
namespace fs = std::filesystem;

namespace {

constexpr const char* kClosuresHeader =
    "reference_session,reference_map,query_session,query_map,source,matches,inliers,status,overlap,"
    "rmse_m,tx,ty,tz,qx,qy,"
    "qz,qw,initial_tx,initial_ty,initial_tz,initial_qx,initial_qy,initial_qz,initial_qw";
constexpr const char* kLocalMapsHeader = "map,first_scan,last_scan,points,tx,ty,tz,qx,qy,qz,qw";

void append_pose(std::string& text, const Pose& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  for (const double v : {pose.translation.x(), pose.translation.y(), pose.translation.z(), q.x(),
                         q.y(), q.z(), q.w()}) {
    text += "," + to_text(v);
  }
}

// A session's name as a field: quoted where it holds a comma or a quote.
std::string quoted(const std::string& name) {
  if (name.find_first_of(",\"\n") == std::string::npos) return name;
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"') text += '"';
    text += c;
  }
  return text + "\"";
}

// One row of a table, with errors that name file, line and column.
class Row {
 public:
  Row(const fs::path& file, std::size_t line, std::string_view text) : file_(file), line_(line) {
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

  void expect_fields(std::size_t n) const {
    if (fields_.size() != n)
      fail(std::to_string(fields_.size()) + " fields, expected " + std::to_string(n));
  }
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
  [[nodiscard]] double number(std::size_t i) const {
    double value = 0.0;
    if (!parse_double(fields_[i], value)) fail("'" + fields_[i] + "' is no finite number");
    return value;
  }
  [[nodiscard]] std::optional<double> optional_number(std::size_t i) const {
    if (fields_[i].empty()) return std::nullopt;
    return number(i);
  }
  [[nodiscard]] Pose pose(std::size_t i) const {
    const Eigen::Quaterniond q(number(i + 6), number(i + 3), number(i + 4), number(i + 5));
    if (std::abs(q.norm() - 1.0) > 1e-3)
      fail("the quaternion has norm " + to_text(q.norm()) + ", expected 1");
    Pose pose;
    pose.rotation = q;  // as it was written, so that a table read and written again is the same
    pose.translation = {number(i), number(i + 1), number(i + 2)};
    return pose;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(file_.string() + ":" + std::to_string(line_) + ": " + what +
                     "; run the session again");
  }

 private:
  const fs::path& file_;
  std::size_t line_;
  std::vector<std::string> fields_;
};

template <typename F>
void for_each_row(const fs::path& file, std::string_view header, F&& f) {
  const std::string text = read_text(file);
  std::string_view rest = text;
  for (std::size_t line = 1; !rest.empty(); ++line) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view row = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line == 1) {
      if (row != header)
        throw InputError(file.string() + ":1: the header is not that of a groundloop table");
      continue;
    }
    if (!row.empty()) f(Row(file, line, row));
  }
}

template <typename Enum, std::size_t N>
Enum enum_from(const Row& row, std::size_t field, const std::array<Enum, N>& values) {
  for (const Enum value : values) {
    if (row.text(field) == to_string(value)) return value;
  }
  row.fail("'" + row.text(field) + "' is unknown");
}

}  // namespace

const char* to_string(ClosureSource source) {
  return source == ClosureSource::detector ? "detector" : "overlap";
}

std::string SessionFolder::name() const {
  const fs::path normal = fs::absolute(path_).lexically_normal();
  return normal.has_filename() ? normal.filename().string()
                               : normal.parent_path().filename().string();
}

fs::path SessionFolder::local_map(int id) const {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "%06d.pcd", id);
  return path_ / "local_maps" / name.data();
}

void write_closures(const fs::path& file, const std::vector<ClosureRecord>& closures) {
  std::string text = std::string(kClosuresHeader) + "\n";
  for (const ClosureRecord& c : closures) {
    text += quoted(c.reference_session) + "," + std::to_string(c.reference_map) + "," +
            quoted(c.query_session) + "," + std::to_string(c.query_map) + "," +
            to_string(c.source) + "," + std::to_string(c.matches) + "," +
            std::to_string(c.inliers) + "," + to_string(c.status) + ",";
    if (c.overlap) text += to_text(*c.overlap);
    text += ",";
    if (c.rmse) text += to_text(*c.rmse);
    append_pose(text, c.T_query_reference);
    append_pose(text, c.initial_T_query_reference);
    text += "\n";
  }
  write_text_atomically(file, text);
}

std::vector<ClosureRecord> read_closures(const fs::path& file) {
  constexpr std::array kSources{ClosureSource::detector, ClosureSource::overlap};
  constexpr std::array kStatuses{ClosureStatus::accepted,     ClosureStatus::few_inliers,
                                 ClosureStatus::icp_diverged, ClosureStatus::low_overlap,
                                 ClosureStatus::inconsistent, ClosureStatus::outlier};
  std::vector<ClosureRecord> closures;
  for_each_row(file, kClosuresHeader, [&](const Row& row) {
    row.expect_fields(24);
    ClosureRecord c;
    c.reference_session = row.text(0);
    c.reference_map = row.integer<int>(1);
    c.query_session = row.text(2);
    c.query_map = row.integer<int>(3);
    c.source = enum_from(row, 4, kSources);
    c.matches = row.integer<int>(5);
    c.inliers = row.integer<int>(6);
    c.status = enum_from(row, 7, kStatuses);
    c.overlap = row.optional_number(8);
    c.rmse = row.optional_number(9);
    c.T_query_reference = row.pose(10);
    c.initial_T_query_reference = row.pose(17);
    closures.push_back(std::move(c));
  });
  return closures;
}

void write_local_maps(const fs::path& file, const std::vector<LocalMapRecord>& maps) {
  std::string text = std::string(kLocalMapsHeader) + "\n";
  for (const LocalMapRecord& m : maps) {
    text += std::to_string(m.map) + "," + std::to_string(m.first_scan) + "," +
            std::to_string(m.last_scan) + "," + std::to_string(m.points);
    append_pose(text, m.T_world_map);
    text += "\n";
  }
  write_text_atomically(file, text);
}

std::vector<LocalMapRecord> read_local_maps(const fs::path& file) {
  std::vector<LocalMapRecord> maps;
  for_each_row(file, kLocalMapsHeader, [&](const Row& row) {
    row.expect_fields(11);
    LocalMapRecord m;
    m.map = row.integer<int>(0);
    m.first_scan = row.integer<std::size_t>(1);
    m.last_scan = row.integer<std::size_t>(2);
    m.points = row.integer<std::size_t>(3);
    m.T_world_map = row.pose(4);
    maps.push_back(m);
  });
  return maps;
}

}  // namespace groundloop
