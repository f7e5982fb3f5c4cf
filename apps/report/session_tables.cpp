#include "apps/report/session_tables.hpp"

#include <functional>
#include <limits>
#include <string_view>

#include "backend/session/table_row.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"

namespace groundloop::apps {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kAbsent = std::numeric_limits<std::size_t>::max();

// A table and where its columns are.
class NamedTable {
 public:
  explicit NamedTable(const fs::path& file) : file_(file), text_(read_text(file)) {
    const std::string_view header(text_.data(), std::min(text_.find('\n'), text_.size()));
    const TableRow row(file_, 1, header);
    for (std::size_t i = 0; i < row.size(); ++i) names_.push_back(row.text(i));
  }

  [[nodiscard]] std::size_t column(std::string_view name) const {
    const std::size_t i = optional_column(name);
    if (i != kAbsent) return i;
    throw InputError(file_.string() + ":1: no column '" + std::string(name) +
                     "'; the table is damaged or of another version, run the recording again");
  }
  [[nodiscard]] std::size_t optional_column(std::string_view name) const {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (names_[i] == name) return i;
    }
    return kAbsent;
  }
  [[nodiscard]] std::size_t columns() const { return names_.size(); }

  void for_each(const std::function<void(const TableRow&)>& f) const {
    for_each_row(file_, text_, 1, [&](const TableRow& row) {
      row.expect_fields(names_.size());
      f(row);
    });
  }

 private:
  fs::path file_;
  std::string text_;
  std::vector<std::string> names_;
};

// An empty field is a value that was not computed.
double number_or_nan(const TableRow& row, std::size_t column) {
  return row.optional_number(column).value_or(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

std::vector<ScanQuality> read_odometry_quality(const fs::path& file) {
  std::vector<ScanQuality> rows;
  if (!fs::exists(file)) return rows;
  const NamedTable table(file);
  const std::size_t scan = table.column("scan");
  const std::size_t state = table.column("state");
  const std::size_t piece = table.column("piece");
  const std::size_t correspondences = table.column("correspondences");
  const std::size_t inlier_share = table.column("inlier_share");
  const std::size_t residual = table.column("residual_m");
  std::array<std::size_t, 6> sigma{};
  constexpr std::array kSigmas{"sigma_tx", "sigma_ty", "sigma_tz",
                               "sigma_rx", "sigma_ry", "sigma_rz"};
  for (std::size_t k = 0; k < 6; ++k) sigma[k] = table.column(kSigmas[k]);
  table.for_each([&](const TableRow& row) {
    ScanQuality quality{row.integer<std::size_t>(scan),
                        row.text(state),
                        row.integer<int>(piece),
                        number_or_nan(row, correspondences),
                        number_or_nan(row, inlier_share),
                        number_or_nan(row, residual),
                        {}};
    for (std::size_t k = 0; k < 6; ++k) quality.sigma[k] = number_or_nan(row, sigma[k]);
    rows.push_back(std::move(quality));
  });
  return rows;
}

std::vector<OdometryPiece> read_pieces(const fs::path& file) {
  std::vector<OdometryPiece> rows;
  if (!fs::exists(file)) return rows;
  const NamedTable table(file);
  const std::size_t piece = table.column("piece");
  const std::size_t first = table.column("first_scan");
  const std::size_t last = table.column("last_scan");
  const std::size_t frame = table.column("frame");
  const std::size_t joined_by = table.column("joined_by");
  const std::size_t reason = table.column("reason");
  table.for_each([&](const TableRow& row) {
    rows.push_back({row.integer<int>(piece), row.integer<std::size_t>(first),
                    row.integer<std::size_t>(last), row.integer<int>(frame), row.text(joined_by),
                    row.text(reason)});
  });
  return rows;
}

std::vector<ScanClosure> read_scan_closures(const fs::path& file) {
  std::vector<ScanClosure> rows;
  if (!fs::exists(file)) return rows;
  const NamedTable table(file);
  const std::size_t reference = table.column("reference_scan");
  const std::size_t query = table.column("query_scan");
  const std::size_t source = table.column("source");
  const std::size_t status = table.column("status");
  const std::size_t overlap = table.column("overlap");
  const std::size_t rmse = table.column("rmse_m");
  const std::size_t weight = table.column("weight");
  const std::size_t pose = table.column("tx");
  for (const char* name : {"ty", "tz", "qx", "qy", "qz", "qw"}) (void)table.column(name);
  table.for_each([&](const TableRow& row) {
    rows.push_back({row.integer<std::size_t>(reference), row.integer<std::size_t>(query),
                    row.text(source), row.text(status), number_or_nan(row, overlap),
                    number_or_nan(row, rmse), number_or_nan(row, weight), row.pose(pose)});
  });
  return rows;
}

std::vector<MapUncertainty> read_uncertainty(const fs::path& file) {
  std::vector<MapUncertainty> rows;
  if (!fs::exists(file)) return rows;
  const NamedTable table(file);
  const std::size_t map = table.column("map");
  if (table.columns() < map + 22)
    throw InputError(file.string() + ":1: " + std::to_string(table.columns()) +
                     " columns; expected map and the 21 of an upper triangle");
  table.for_each([&](const TableRow& row) {
    MapUncertainty uncertainty;
    uncertainty.map = row.integer<int>(map);
    std::size_t field = map + 1;
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) {
        uncertainty.covariance(i, j) = uncertainty.covariance(j, i) = row.number(field++);
      }
    }
    rows.push_back(uncertainty);
  });
  return rows;
}

}  // namespace groundloop::apps
