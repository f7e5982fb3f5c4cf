// The session folder: what a run leaves behind, and the contract between stages, runs and machines.
// Reads and writes its tables; every file is written aside and renamed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "backend/registration/verification.hpp"
#include "frontend/core/pose.hpp"

namespace groundloop {

class TableRow;

enum class ClosureSource { detector, overlap };
[[nodiscard]] const char* to_string(ClosureSource source);

/// One row of closures.csv: a candidate, accepted or not.
struct ClosureRecord {
  std::string reference_session;
  int reference_map = 0;
  std::string query_session;
  int query_map = 0;
  ClosureSource source = ClosureSource::detector;
  int matches = 0;
  int inliers = 0;
  ClosureStatus status = ClosureStatus::few_inliers;
  std::optional<double> overlap;
  std::optional<double> rmse;       ///< m, of ICP
  std::optional<double> agreement;  ///< of tall structure, see ColumnAgreement; not in the table
  Pose T_query_reference;           ///< refined where ICP ran, else the initial one
  Pose initial_T_query_reference;   ///< the detector's own
  Matrix6d information =
      Matrix6d::Zero();  ///< of T_query_reference; kept in pose_graph.g2o, not in the table
  double weight = 0.0;   ///< the robust solver's, in [0, 1]; not in the table
};

/// One row of local_maps.csv.
struct LocalMapRecord {
  int map = 0;
  std::size_t first_scan = 0;
  std::size_t last_scan = 0;  ///< included
  std::size_t points = 0;
  Pose T_world_map;
};

/// Names of a session's files.
class SessionFolder {
 public:
  explicit SessionFolder(std::filesystem::path path) : path_(std::move(path)) {}
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The folder's own name, by which a merge calls the session. No file of the session holds it, so
  /// that the same run gives the same bytes wherever it is kept, and a folder may be renamed.
  [[nodiscard]] std::string name() const;
  [[nodiscard]] std::filesystem::path local_map(int id) const;
  /// The n-th file of kept scans (scan_file.hpp).
  [[nodiscard]] std::filesystem::path scan_file(std::size_t n) const;
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return path_ / name; }

  /// Files that the same input, configuration and version give the same bytes of; local maps, kept
  /// scans and tables of merged parts are such files, too.
  [[nodiscard]] static const std::vector<std::string>& lasting_files();
  /// Every other file that a session may hold: what holds times or logs, and what an unfinished one
  /// needs to be resumed.
  [[nodiscard]] static const std::vector<std::string>& other_files();
  /// The tables of one recording below sessions/NAME.
  [[nodiscard]] static const std::vector<std::string>& part_files();

 private:
  std::filesystem::path path_;
};

/// The columns of closures.csv, one row without its line break, and a closure from a row that has
/// at least kClosureFields fields. For tables that hold more than closures.csv does.
inline constexpr std::size_t kClosureFields = 24;
[[nodiscard]] const char* closure_header();
[[nodiscard]] std::string closure_row(const ClosureRecord& closure);
[[nodiscard]] ClosureRecord closure_from(const TableRow& row);

void write_closures(const std::filesystem::path& file, const std::vector<ClosureRecord>& closures);
/// Throws InputError naming file, line and column.
[[nodiscard]] std::vector<ClosureRecord> read_closures(const std::filesystem::path& file);

void write_local_maps(const std::filesystem::path& file, const std::vector<LocalMapRecord>& maps);
[[nodiscard]] std::vector<LocalMapRecord> read_local_maps(const std::filesystem::path& file);

}  // namespace groundloop
