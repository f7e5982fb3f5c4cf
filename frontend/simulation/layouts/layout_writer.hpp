// Writing a recording in the layout of a dataset or recorder, so that every reader can be tried on
// files of the real shape, and a simulated recording can be given to other programs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "frontend/core/progress.hpp"
#include "frontend/recordings/recording.hpp"

namespace groundloop {

/// kitti, mulran, helipr, nclt, rosbag, rosbag2, mcap, folder, livox (a bag of CustomMsg).
[[nodiscard]] const std::vector<std::string>& layout_names();

/// Writes all scans and the ground truth (as the layout keeps it, else as ground_truth.tum) to
/// `folder`, which must be new or empty and appears whole or not at all. `sensor` names HeLiPR's
/// record (Ouster, Velodyne, Avia, Aeva). Throws InputError where the layout cannot hold the
/// recording.
void write_layout(Recording& recording, const std::string& layout,
                  const std::filesystem::path& folder, const std::string& sensor = "Ouster",
                  const Progress& progress = {});

namespace layouts {

/// What a writer knows before the first scan.
struct Source {
  std::vector<Nanoseconds> stamps;
  Nanoseconds period = 100'000'000;  ///< median scan interval
  /// T_world_scan at the scans' stamps, one a scan; empty where it is not known for all.
  Trajectory ground_truth;
};

/// Files of one layout, written scan by scan.
class Writer {
 public:
  virtual ~Writer() = default;
  virtual void write(std::size_t index, const Scan& scan) = 0;
  virtual void finish() {}
};

[[nodiscard]] std::unique_ptr<Writer> make_kitti_writer(const std::filesystem::path& folder,
                                                        const Source& source);
[[nodiscard]] std::unique_ptr<Writer> make_mulran_writer(const std::filesystem::path& folder,
                                                         const Source& source);
[[nodiscard]] std::unique_ptr<Writer> make_helipr_writer(const std::filesystem::path& folder,
                                                         const Source& source,
                                                         const std::string& sensor);
[[nodiscard]] std::unique_ptr<Writer> make_nclt_writer(const std::filesystem::path& folder,
                                                       const Source& source);
[[nodiscard]] std::unique_ptr<Writer> make_rosbag_writer(const std::filesystem::path& folder,
                                                         const Source& source);
[[nodiscard]] std::unique_ptr<Writer> make_livox_writer(const std::filesystem::path& folder,
                                                        const Source& source);
[[nodiscard]] std::unique_ptr<Writer> make_rosbag2_writer(const std::filesystem::path& folder,
                                                          const Source& source);
[[nodiscard]] std::unique_ptr<Writer> make_mcap_writer(const std::filesystem::path& folder,
                                                       const Source& source);
[[nodiscard]] std::unique_ptr<Writer> make_folder_writer(const std::filesystem::path& folder,
                                                         const Source& source);

}  // namespace layouts
}  // namespace groundloop
