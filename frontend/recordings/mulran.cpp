// MulRan (Kim et al., ICRA 2020): Ouster OS1-64 scans of 1024 columns, stored column after column.
#include "frontend/core/error.hpp"
#include "frontend/recordings/dataset_calibration.hpp"
#include "frontend/recordings/datasets.hpp"
#include "frontend/recordings/ground_truth.hpp"
#include "frontend/recordings/scan_files.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kRecord = 4 * sizeof(float);
constexpr const char* kFields = "float32 x y z intensity";

fs::path scan_folder(const fs::path& path) {
  std::error_code error;
  for (const fs::path& folder : {path / "sensor_data" / "Ouster", path / "Ouster"}) {
    if (fs::is_directory(folder, error)) return folder;
  }
  return {};
}

class MulranRecording final : public ScanFiles {
 public:
  MulranRecording(const fs::path& path, const RecordingOptions& options)
      : ScanFiles(path, "mulran", scan_folder(path), ".bin", options) {
    take_stamps_from_names(1, "ns");
    check_lengths(kRecord, kFields);
    info_.sensor = "Ouster OS1-64";
    info_.fields = {"x", "y", "z", "intensity"};
    info_.attributes.intensity = true;
    info_.point_times = "column of the record, 1024 in 0.1 s, in scans of 64 x 1024 records";
    load_ground_truth(path);
  }

 private:
  void load_ground_truth(const fs::path& path) {
    std::error_code error;
    const fs::path file = path / "global_pose.csv";
    if (!fs::exists(file, error)) return;
    const NumberTable table = read_numbers(file);
    if (table.columns != 13) {
      throw InputError(file.string() + ": " + std::to_string(table.columns) +
                       " columns; expected 13 (stamp in ns and a 3x4 matrix)");
    }
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      double matrix[12];
      std::copy(table.rows[i].begin() + 1, table.rows[i].end(), matrix);
      const Pose T_world_base =
          pose_from_matrix(matrix, file.string() + ":" + std::to_string(table.lines[i]) + ": ");
      ground_truth_.push_back(
          {stamp_of_row(file, table, i, 1), T_world_base * mulran_base_from_lidar()});
    }
    info_.notes.emplace_back(
        "Ground truth is global_pose.csv, brought from the vehicle to the LiDAR with the dataset's "
        "calibration.");
  }

  std::size_t decode(std::size_t index, Scan& scan) override {
    const std::size_t count = record_count(index, kRecord, kFields);
    const bool whole = count == kMulranRows * kMulranColumns;
    decode_table(index, {layout_, count}, {nullptr, {}, &records_}, scan);
    for (std::size_t i = 0; whole && i < records_.size(); ++i) {
      scan.times.push_back(static_cast<float>(records_[i] / kMulranRows) *
                           static_cast<float>(kMulranTurn / kMulranColumns));
    }
    return count;
  }

  const PointLayout layout_ = float_records(kKittiFields);
  std::vector<std::uint32_t> records_;
};

}  // namespace

bool is_mulran(const fs::path& path) { return !scan_folder(path).empty(); }

std::unique_ptr<Recording> open_mulran(const fs::path& path, const RecordingOptions& options) {
  if (!is_mulran(path)) throw InputError(path.string() + ": no folder sensor_data/Ouster here");
  return std::make_unique<MulranRecording>(path, options);
}

}  // namespace groundloop::recordings
