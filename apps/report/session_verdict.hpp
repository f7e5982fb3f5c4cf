// What a session says for and against its own result. Every remark names the figure it rests on;
// the limits stand in session_verdict.cpp.
#pragma once

#include <vector>

#include "apps/report/closure_table.hpp"
#include "apps/report/scan_table.hpp"
#include "apps/report/session_contents.hpp"
#include "apps/report/verdict.hpp"

namespace groundloop::apps {

[[nodiscard]] Verdict judge_session(const SessionContents& contents, const ScanTable& table,
                                    const std::vector<ClosureRow>& closures);

}  // namespace groundloop::apps
