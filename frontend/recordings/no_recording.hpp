// What is said about a path that is no recording: what it is instead, what converts it, where the
// recordings are that may be meant.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace groundloop::recordings {

/// Throws InputError for what is known to be no recording that is read: a session of groundloop,
/// files of other formats, archives; with what to do about it.
void refuse_what_is_no_recording(const std::filesystem::path& path);

/// The message for a path in which no format is recognised: recordings in the folders below it, if
/// `is_recording` finds some, else what was looked for.
[[nodiscard]] std::string not_recognised(
    const std::filesystem::path& path, const std::string& looked_for,
    const std::function<bool(const std::filesystem::path&)>& is_recording);

}  // namespace groundloop::recordings
