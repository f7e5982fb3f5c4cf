// Progress on a terminal: one line with a bar, the rate and the time left. In a file nothing of it
// appears. Also carries Ctrl-C into the work: the next progress report throws Interrupted.
#pragma once

#include "apps/commands/commands.hpp"
#include "frontend/core/progress.hpp"

namespace groundloop::apps {

/// A callback that draws the bar unless quiet or standard error is no terminal.
[[nodiscard]] Progress make_progress(const Context& context);

/// Ends the bar's line, before anything else is printed.
void end_progress();

/// Ctrl-C, SIGTERM and a terminal that closes stop the work at its next report instead of killing
/// it.
void stop_on_signals();

}  // namespace groundloop::apps
