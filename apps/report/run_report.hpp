// The report of one run, filled from its result.
#pragma once

#include <optional>
#include <string>

#include "apps/config/config.hpp"
#include "apps/report/session_documents.hpp"
#include "frontend/recordings/recording.hpp"

namespace groundloop::apps {

/// The page report.html. Pictures are made of the local maps in
/// `session`.
[[nodiscard]] std::string make_run_report(const Recording& recording, const Config& config,
                                          const SlamResult& result,
                                          const std::optional<RunEvaluation>& evaluation,
                                          const SessionFolder& session);

}  // namespace groundloop::apps
