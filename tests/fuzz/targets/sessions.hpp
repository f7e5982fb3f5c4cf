// A session from a bundle of files: its manifest is given the checksums that the files have, so
// that what is wrong with them is not hidden behind a checksum.
#pragma once

#include <filesystem>
#include <string_view>

namespace groundloop::fuzz {

/// Lays the bundle out as the session `name`; the manifest's checksums are made right where it is
/// JSON.
[[nodiscard]] std::filesystem::path lay_out_session(const char* name, std::string_view bundle);

}  // namespace groundloop::fuzz
