// The point clouds of one topic of several message files, in the order of their header stamps.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "frontend/recordings/message_file.hpp"
#include "frontend/recordings/recording.hpp"

namespace groundloop::recordings {

/// `files` with the path that each is named by in messages.
struct NamedFile {
  std::string name;
  std::unique_ptr<MessageFile> file;
};

/// Throws InputError where options.topic (or, if empty, the only point-cloud topic) is not to be
/// found. Messages that are too short or hold no points are left out and counted; equal stamps are
/// kept once; where all header stamps are equal the times of recording stand in for them.
[[nodiscard]] std::unique_ptr<Recording> make_bag_recording(const std::string& path,
                                                            const char* format,
                                                            std::vector<NamedFile> files,
                                                            const RecordingOptions& options,
                                                            std::vector<std::string> notes);

}  // namespace groundloop::recordings
