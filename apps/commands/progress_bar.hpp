// Progress on a terminal: one line with a bar, the rate and the time left. In a file, or on a
// terminal that cannot draw a line anew, nothing of it appears. Also carries Ctrl-C into the work:
// the next progress report throws Interrupted.
#pragma once

#include "apps/commands/commands.hpp"
#include "frontend/core/progress.hpp"

namespace groundloop::apps {

/// The line: stage, bar where there is room for it, done of `total` (0: not known), `rate` a second
/// (0: not known), time left. At most `width` characters, so that the terminal does not break it.
[[nodiscard]] std::string progress_line(const std::string& stage, std::size_t done,
                                        std::size_t total, double rate, std::size_t width);

/// A callback that draws the bar unless quiet or standard error is no terminal.
[[nodiscard]] Progress make_progress(const Context& context);

/// Ends the bar's line, before anything else is printed.
void end_progress();

/// Ctrl-C, SIGTERM and a terminal that closes stop the work at its next report instead of killing
/// it.
void stop_on_signals();

}  // namespace groundloop::apps
