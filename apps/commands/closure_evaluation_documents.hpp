// The evaluation of closures as JSON, and as tables for the terminal and a page.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/report/html_page.hpp"
#include "loopclosure/evaluation/evaluation.hpp"

namespace groundloop::apps {

/// `notes` are what is to be said of ground truth and list.
[[nodiscard]] nlohmann::ordered_json closure_evaluation_json(
    const ClosureEvaluation& evaluation, const ClosureEvaluationOptions& options,
    const std::vector<std::string>& notes);

[[nodiscard]] std::vector<PageTable> closure_evaluation_tables(
    const ClosureEvaluation& evaluation, const ClosureEvaluationOptions& options);

}  // namespace groundloop::apps
