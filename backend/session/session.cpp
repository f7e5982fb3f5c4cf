#include "backend/session/session.hpp"

#include <array>
#include <cstdio>

#include "backend/session/table_row.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop {
namespace fs = std::filesystem;

namespace {

constexpr const char* kClosuresHeader =
    "reference_session,reference_map,query_session,query_map,source,matches,inliers,status,overlap,"
    "rmse_m,tx,ty,tz,qx,qy,"
    "qz,qw,initial_tx,initial_ty,initial_tz,initial_qx,initial_qy,initial_qz,initial_qw";
constexpr const char* kLocalMapsHeader = "map,first_scan,last_scan,points,tx,ty,tz,qx,qy,qz,qw";

// The text of a table below its header.
std::string read_table(const fs::path& file, const std::string& header) {
  std::string text = read_text(file);
  if (text.compare(0, header.size() + 1, header + "\n") != 0)
    throw InputError(file.string() + ":1: the header is not that of a groundloop table");
  return text;
}

template <typename Enum, std::size_t N>
Enum enum_from(const TableRow& row, std::size_t field, const std::array<Enum, N>& values) {
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

fs::path SessionFolder::scan_file(std::size_t n) const {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "%06zu.bin", n);
  return path_ / "scans" / name.data();
}

const std::vector<std::string>& SessionFolder::lasting_files() {
  static const std::vector<std::string> names{
      "config.yaml",    "odometry.tum",         "trajectory.tum", "trajectory.kitti",
      "closures.csv",   "pose_graph.g2o",       "local_maps.csv", "loop_database.bin",
      "map.pcd",        "odometry_quality.csv", "pieces.csv",     "scan_closures.csv",
      "uncertainty.csv"};
  return names;
}

const std::vector<std::string>& SessionFolder::other_files() {
  static const std::vector<std::string> names{"manifest.json", "metrics.json", "report.html",
                                              "run.log", "checkpoint.bin"};
  return names;
}

const std::vector<std::string>& SessionFolder::part_files() {
  static const std::vector<std::string> names{"odometry.tum", "trajectory.tum", "trajectory.kitti",
                                              "local_maps.csv"};
  return names;
}

const char* closure_header() { return kClosuresHeader; }

std::string closure_row(const ClosureRecord& c) {
  std::string text = quoted(c.reference_session) + "," + std::to_string(c.reference_map) + "," +
                     quoted(c.query_session) + "," + std::to_string(c.query_map) + "," +
                     to_string(c.source) + "," + std::to_string(c.matches) + "," +
                     std::to_string(c.inliers) + "," + to_string(c.status) + ",";
  if (c.overlap) text += to_text(*c.overlap);
  text += ",";
  if (c.rmse) text += to_text(*c.rmse);
  append_pose(text, c.T_query_reference);
  append_pose(text, c.initial_T_query_reference);
  return text;
}

ClosureRecord closure_from(const TableRow& row) {
  constexpr std::array kSources{ClosureSource::detector, ClosureSource::overlap};
  constexpr std::array kStatuses{ClosureStatus::accepted,     ClosureStatus::few_inliers,
                                 ClosureStatus::icp_diverged, ClosureStatus::low_overlap,
                                 ClosureStatus::inconsistent, ClosureStatus::outlier};
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
  return c;
}

void write_closures(const fs::path& file, const std::vector<ClosureRecord>& closures) {
  std::string text = std::string(kClosuresHeader) + "\n";
  for (const ClosureRecord& c : closures) text += closure_row(c) + "\n";
  write_text_atomically(file, text);
}

std::vector<ClosureRecord> read_closures(const fs::path& file) {
  std::vector<ClosureRecord> closures;
  for_each_row(file, read_table(file, kClosuresHeader), 1, [&](const TableRow& row) {
    row.expect_fields(kClosureFields);
    closures.push_back(closure_from(row));
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
  for_each_row(file, read_table(file, kLocalMapsHeader), 1, [&](const TableRow& row) {
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
