// Recordings around a recording: a range of its scans, its scans with the elevation corrected, its
// stamps taken for another instant.
#pragma once

#include <memory>

#include "frontend/recordings/recording.hpp"

namespace groundloop::recordings {

/// Scans [first, first + count) of a recording. Throws InputError where there are none.
[[nodiscard]] std::unique_ptr<Recording> slice(std::unique_ptr<Recording> inner, std::size_t first,
                                               std::size_t count);

/// Every point raised by KITTI's 0.205 degrees, and a note that says so.
[[nodiscard]] std::unique_ptr<Recording> with_elevation_correction(std::unique_ptr<Recording> inner,
                                                                   const std::string& reason);

/// Times of points counted so that the stamp names the `instant` ("start", "middle", "end") of each
/// scan. Reads a few scans. Throws InputError for another word.
[[nodiscard]] std::unique_ptr<Recording> with_stamp_at(std::unique_ptr<Recording> inner,
                                                       const std::string& instant);

/// What the options ask for around a recording that was opened: elevation correction, instant of
/// the stamps, range of scans.
[[nodiscard]] std::unique_ptr<Recording> wrap(std::unique_ptr<Recording> recording,
                                              const RecordingOptions& options);

/// The same recording with one more note.
[[nodiscard]] std::unique_ptr<Recording> with_note(std::unique_ptr<Recording> inner,
                                                   const std::string& note);

}  // namespace groundloop::recordings
