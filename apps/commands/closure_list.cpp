#include "apps/commands/closure_list.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "backend/session/table_row.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"

namespace groundloop::apps {
namespace {

constexpr std::array<const char*, 7> kPose{"tx", "ty", "tz", "qx", "qy", "qz", "qw"};

// Where the columns of a list are.
class Columns {
 public:
  explicit Columns(const TableRow& header) {
    for (std::size_t i = 0; i < header.size(); ++i) at_[header.text(i)] = i;
    maps_ = has("reference_map") && has("query_map");
    if (!maps_ && !(has("reference_scan") && has("query_scan"))) {
      header.fail(
          "the first line must name the columns, reference_map and query_map or reference_scan and "
          "query_scan among them");
    }
    score_ = has("score") ? "score" : has("inliers") ? "inliers" : "";
    // groundloop's own tables: the detector's pose before registration.
    prefix_ = has("initial_tx") ? "initial_" : "";
    pose_ = std::all_of(kPose.begin(), kPose.end(),
                        [&](const char* name) { return has(prefix_ + name); });
  }
  [[nodiscard]] bool has(const std::string& name) const { return at_.contains(name); }
  [[nodiscard]] std::size_t at(const std::string& name) const { return at_.at(name); }
  [[nodiscard]] bool of_maps() const { return maps_; }
  [[nodiscard]] double score(const TableRow& row) const {
    return score_.empty() ? 1.0 : row.number(at(score_));
  }
  [[nodiscard]] std::optional<Pose> pose(const TableRow& row) const {
    if (!pose_) return std::nullopt;
    std::array<double, 7> v{};
    for (std::size_t i = 0; i < v.size(); ++i) {
      const std::size_t column = at(prefix_ + kPose[i]);
      if (row.text(column).empty()) return std::nullopt;
      v[i] = row.number(column);
    }
    return Pose(Eigen::Quaterniond(v[6], v[3], v[4], v[5]), {v[0], v[1], v[2]});
  }

 private:
  std::map<std::string, std::size_t> at_;
  bool maps_ = false, pose_ = false;
  std::string score_, prefix_;
};

class ListReader {
 public:
  ListReader(const std::filesystem::path& file, const std::vector<EvaluatedPart>& parts)
      : file_(file), parts_(parts) {}

  std::vector<ReportedClosure> read() {
    const std::string text = read_text(file_);
    std::optional<Columns> columns;
    for_each_row(file_, text, 0, [&](const TableRow& row) {
      if (row.text(0).rfind('#', 0) == 0) return;
      if (!columns) {
        columns.emplace(row);
        fields_ = row.size();
        return;
      }
      row.expect_fields(fields_);
      add(row, *columns);
    });
    if (!columns) throw InputError(file_.string() + ": is empty; a list has a line of columns");
    std::vector<ReportedClosure> closures;
    for (auto& [pair, closure] : best_) closures.push_back(std::move(closure));
    return closures;
  }

 private:
  [[nodiscard]] int part_of(const TableRow& row, const Columns& columns, const char* name,
                            int otherwise) const {
    if (!columns.has(name) || parts_.size() == 1) return otherwise;
    const std::string& session = row.text(columns.at(name));
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      if (parts_[p].name == session) return static_cast<int>(p);
    }
    row.fail("no session is called '" + session + "'");
  }

  // A map, and the pose of what the row names in it.
  struct Place {
    MapKey key;
    Pose T_map_row;
  };
  [[nodiscard]] Place place(const TableRow& row, const Columns& columns, bool reference,
                            int otherwise) const {
    const std::string side = reference ? "reference" : "query";
    const int session = part_of(row, columns, (side + "_session").c_str(), otherwise);
    const EvaluatedPart& part = parts_[static_cast<std::size_t>(session)];
    if (columns.of_maps()) {
      const int map = row.integer<int>(columns.at(side + "_map"));
      if (map < 0 || map >= static_cast<int>(part.maps.size())) {
        row.fail("there is no local map " + std::to_string(map) + " in " + part.tables.string());
      }
      return {{session, map}, Pose()};
    }
    const auto scan = row.integer<std::size_t>(columns.at(side + "_scan"));
    for (std::size_t m = 0; m < part.maps.size(); ++m) {
      const LocalMapRecord& record = part.maps[m];
      if (record.first_scan > scan || scan > record.last_scan) continue;
      return {{session, static_cast<int>(m)},
              part.odometry[record.first_scan].pose.inverse() * part.odometry[scan].pose};
    }
    row.fail("there is no scan " + std::to_string(scan) + " in " + part.tables.string());
  }

  void add(const TableRow& row, const Columns& columns) {
    Place reference = place(row, columns, true, 0);
    Place query = place(row, columns, false, static_cast<int>(parts_.size()) - 1);
    ReportedClosure closure;
    closure.score = columns.score(row);
    if (const std::optional<Pose> T = columns.pose(row)) {
      Pose between = query.T_map_row * *T * reference.T_map_row.inverse();
      if (query.key < reference.key) between = between.inverse();
      closure.initial_T_query_reference = between;
    }
    closure.reference = std::min(reference.key, query.key);
    closure.query = std::max(reference.key, query.key);
    const auto [it, is_new] = best_.try_emplace({closure.query, closure.reference}, closure);
    if (!is_new && closure.score > it->second.score) it->second = closure;
  }

  const std::filesystem::path& file_;
  const std::vector<EvaluatedPart>& parts_;
  std::size_t fields_ = 0;
  std::map<std::pair<MapKey, MapKey>, ReportedClosure> best_;
};

}  // namespace

std::vector<ReportedClosure> session_closures(const std::vector<EvaluatedPart>& parts) {
  const std::filesystem::path file = SessionFolder(parts.front().session).file("closures.csv");
  std::vector<ReportedClosure> closures;
  for (const ClosureRecord& record : read_closures(file)) {
    // A session that was moved keeps the name it had in its table.
    const auto number = [&](const std::string& name) {
      if (parts.size() == 1) return 0;
      for (std::size_t p = 0; p < parts.size(); ++p) {
        if (parts[p].name == name) return static_cast<int>(p);
      }
      throw InputError(file.string() + ": session " + name + " is not in the manifest");
    };
    ReportedClosure closure;
    closure.reference = {number(record.reference_session), record.reference_map};
    closure.query = {number(record.query_session), record.query_map};
    closure.detector = record.source == ClosureSource::detector;
    closure.accepted = record.status == ClosureStatus::accepted;
    closure.score = record.inliers;
    closure.T_query_reference = record.T_query_reference;
    closure.initial_T_query_reference = record.initial_T_query_reference;
    closures.push_back(closure);
  }
  return closures;
}

std::vector<ReportedClosure> read_closure_list(const std::filesystem::path& file,
                                               const std::vector<EvaluatedPart>& parts) {
  return ListReader(file, parts).read();
}

}  // namespace groundloop::apps
