// A compressed file of a recording, unpacked where nobody else can reach it and gone again as soon
// as it is open: whatever ends the process, nothing stays.
#pragma once

#include <filesystem>
#include <memory>

#include "frontend/recordings/message_file.hpp"

namespace groundloop::recordings {

using FileOpener = std::unique_ptr<MessageFile> (*)(const std::filesystem::path&);

/// Unpacks a .zstd file into a folder of its own below the folder of temporary files (TMPDIR),
/// opens the copy, and removes both; `open` must keep the file open. Throws InputError naming
/// the file where it is broken, unpacks to more than a file of its length can hold, or where there
/// is no room.
[[nodiscard]] std::unique_ptr<MessageFile> open_unpacked(const std::filesystem::path& compressed,
                                                         FileOpener open);

}  // namespace groundloop::recordings
