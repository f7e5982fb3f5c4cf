// A capture of a sensor's packets, and the metadata that lie beside it.
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/packets/ouster_metadata.hpp"
#include "frontend/recordings/packets/packet_recording.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

std::vector<fs::path> captures_of(const fs::path& path) {
  std::error_code error;
  if (path.extension() == ".pcap" && fs::is_regular_file(path, error)) return {path};
  if (!fs::is_directory(path, error)) return {};
  return list_files(path, ".pcap");
}

// The metadata beside a capture: the JSON file with the longest name that the capture's name begins
// with, else the only one that an Ouster sensor wrote. All that one wrote come out in `of_sensors`.
fs::path metadata_beside(const fs::path& capture, std::vector<fs::path>& of_sensors) {
  constexpr std::uintmax_t kLargest = 1U << 20U;
  const fs::path folder = capture.has_parent_path() ? capture.parent_path() : fs::path(".");
  const std::string name = capture.stem().string();
  fs::path best;
  for (const fs::path& file : list_files(folder, ".json")) {
    std::error_code error;
    if (fs::file_size(file, error) > kLargest || error) continue;
    if (!is_ouster_metadata(read_text(file))) continue;
    of_sensors.push_back(file);
    if (name.starts_with(file.stem().string()) &&
        file.stem().string().size() > best.stem().string().size())
      best = file;
  }
  if (best.empty() && of_sensors.size() == 1) return of_sensors.front();
  return best;
}

}  // namespace

bool is_pcap(const fs::path& path) { return !captures_of(path).empty(); }

std::unique_ptr<Recording> open_pcap(const fs::path& path, const RecordingOptions& options) {
  const std::vector<fs::path> captures = captures_of(path);
  if (captures.empty()) throw InputError(path.string() + ": holds no *.pcap file");
  if (captures.size() > 1) {
    throw InputError(path.string() + ": holds " + std::to_string(captures.size()) +
                     " captures; name one of them, e.g. " + captures.front().string());
  }
  PacketSource source;
  source.path = path.string();
  source.format = "pcap";
  source.stream = open_pcap_packets(captures.front());
  if (options.calibration.empty()) {
    const fs::path metadata = metadata_beside(captures.front(), source.metadata_candidates);
    if (!metadata.empty()) {
      source.metadata = read_text(metadata);
      source.notes.push_back("Metadata are " + metadata.filename().string() + ".");
    }
  }
  return make_packet_recording(std::move(source), options);
}

}  // namespace groundloop::recordings
