#include "apps/benchmark/collect.hpp"

#include <algorithm>

#include "apps/benchmark/measures.hpp"
#include "apps/benchmark/step_runner.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"

namespace groundloop::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json document(const fs::path& file) {
  if (file.empty() || !fs::exists(file)) return {};
  Json json = Json::parse(read_text(file), nullptr, false);
  if (json.is_discarded()) {
    throw InputError(file.string() + ": no JSON; remove it and run the benchmark again");
  }
  return json;
}

Detections detections_from(const Json& closures) {
  Detections d;
  const Json& references = closures.at("references");
  d.references = references.at("count").get<std::size_t>();
  d.uncertain = references.at("uncertain").get<std::size_t>();
  d.eligible = references.at("eligible").get<std::size_t>();
  d.poses = closures.at("judged").empty();
  for (const Json& c : closures.at("judged")) {
    d.poses = d.poses || !c.at("initial_meeting").is_null();
    d.closures.push_back({c.at("score").get<double>(), c.at("true").get<bool>(),
                          c.at("uncertain").get<bool>(), c.at("right_pose").get<bool>()});
  }
  return d;
}

std::string name_of(const Result& r) {
  std::string name = r.subject + ", " + r.configuration;
  if (!r.detector.empty()) name += ", " + r.detector;
  if (!r.repetition.empty()) name += " (" + r.repetition + ")";
  return name;
}

Result read_result(const ResultSource& source, const fs::path& out) {
  Result result = source.result;
  ResultDocuments documents;
  documents.metrics = document(source.metrics);
  documents.session = document(source.session);
  documents.closures = document(source.closures);
  documents.step = document(step_stamp(out, source.measured_step));
  documents.expected_to_join = source.expected_to_join;
  for (const Measure& measure : measures()) {
    if (!measure.extract) continue;
    if (const auto value = measure.extract(documents)) result.figures[measure.name] = *value;
  }
  if (!documents.closures.is_null()) {
    try {
      result.detections = detections_from(documents.closures);
    } catch (const Json::exception& e) {
      throw InputError(source.closures.string() + ": " + e.what() +
                       "; remove it and run the benchmark again");
    }
  }
  return result;
}

}  // namespace

Results collect_results(const Suite& suite, const SuitePlan& plan, const fs::path& out) {
  Results results;
  results.title = suite.title;
  results.gaps = plan.gaps;
  for (const ResultSource& source : plan.sources) {
    const auto step = std::find_if(plan.steps.begin(), plan.steps.end(),
                                   [&](const Step& s) { return s.name == source.step; });
    if (is_done(plan.steps, *step, out)) {
      results.results.push_back(read_result(source, out));
    } else {
      results.gaps.push_back({name_of(source.result), "step " + source.step + " is not done"});
    }
  }
  return results;
}

}  // namespace groundloop::apps
