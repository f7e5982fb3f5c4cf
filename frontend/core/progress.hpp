// How libraries tell of long work: a callback, never the terminal.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace groundloop {

/// progress(stage, done, total); total 0 where it is not known. May throw Interrupted to stop the
/// work.
using Progress = std::function<void(const std::string& stage, std::size_t done, std::size_t total)>;

}  // namespace groundloop
