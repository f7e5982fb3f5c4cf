// A recording of a sensor's raw packets: cut into turns of the head, decoded when a scan is read.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "frontend/recordings/bag_recording.hpp"
#include "frontend/recordings/packets/packet_stream.hpp"
#include "frontend/recordings/recording.hpp"

namespace groundloop::recordings {

struct PacketSource {
  std::string path;
  const char* format = "";
  std::vector<NamedFile> files;  ///< that the stream reads from; may be empty
  std::unique_ptr<PacketStream> stream;
  std::string metadata;  ///< Ouster: JSON text beside the packets, if any
  /// Files of metadata beside the packets that may be meant, where none is by its name.
  std::vector<std::filesystem::path> metadata_candidates;
  std::vector<std::string> notes, warnings;
};

/// Goes once through all packets. Throws InputError where none is of a sensor whose packets are
/// decoded, or where its calibration is missing.
[[nodiscard]] std::unique_ptr<Recording> make_packet_recording(PacketSource source,
                                                               const RecordingOptions& options);

[[nodiscard]] bool is_pcap(const std::filesystem::path& path);
/// A capture (.pcap), or a folder of one. An Ouster's metadata are the JSON file whose name the
/// capture's begins with, or options.calibration.
[[nodiscard]] std::unique_ptr<Recording> open_pcap(const std::filesystem::path& path,
                                                   const RecordingOptions& options);

}  // namespace groundloop::recordings
