// A recording from a bundle of files, read whole and put through the front end.
#pragma once

#include "frontend/recordings/recording.hpp"
#include "tests/fuzz/pipeline.hpp"
#include "tests/fuzz/scratch_folder.hpp"

namespace groundloop::fuzz {

/// The files of the input as a folder, opened as `format`.
inline void read_recording(Input input, const char* format) {
  RecordingOptions options;
  options.format = format;
  use(*open_recording(lay_out(format, split_bundle(text_of(input))).string(), options));
}

}  // namespace groundloop::fuzz
