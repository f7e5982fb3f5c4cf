#include "apps/benchmark/results.hpp"

#include <nlohmann/json.hpp>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop::apps {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;

Json to_json(const Detections& d) {
  Json closures = Json::array();
  for (const JudgedClosure& c : d.closures) {
    closures.push_back({c.score, c.correct ? 1 : 0, c.uncertain ? 1 : 0, c.right_pose ? 1 : 0});
  }
  return {{"references", d.references},
          {"uncertain", d.uncertain},
          {"eligible", d.eligible},
          {"poses", d.poses},
          {"closures", closures}};
}

Detections detections_from(const Json& json) {
  Detections d;
  d.references = json.at("references").get<std::size_t>();
  d.uncertain = json.at("uncertain").get<std::size_t>();
  d.eligible = json.at("eligible").get<std::size_t>();
  d.poses = json.at("poses").get<bool>();
  for (const Json& c : json.at("closures")) {
    d.closures.push_back({c.at(0).get<double>(), c.at(1).get<int>() != 0, c.at(2).get<int>() != 0,
                          c.at(3).get<int>() != 0});
  }
  return d;
}

Json to_json(const Result& r) {
  Json json{{"kind", r.kind},
            {"subject", r.subject},
            {"group", r.group},
            {"configuration", r.configuration},
            {"detector", r.detector},
            {"repetition", r.repetition},
            {"references", r.references},
            {"figures", r.figures}};
  if (r.detections) json["detections"] = to_json(*r.detections);
  return json;
}

Result result_from(const Json& json) {
  Result r;
  r.kind = json.at("kind").get<std::string>();
  r.subject = json.at("subject").get<std::string>();
  r.group = json.at("group").get<std::string>();
  r.configuration = json.at("configuration").get<std::string>();
  r.detector = json.at("detector").get<std::string>();
  r.repetition = json.at("repetition").get<std::string>();
  r.references = json.at("references").get<std::string>();
  for (const auto& [name, value] : json.at("figures").items()) {
    r.figures[name] = value.get<double>();
  }
  if (json.contains("detections")) r.detections = detections_from(json.at("detections"));
  return r;
}

}  // namespace

PrecisionRecall pooled_curve(const std::vector<const Detections*>& detections, Counting counting) {
  std::size_t references = 0;
  std::vector<ScoredClosure> scored;
  for (const Detections* d : detections) {
    const bool certain = counting == Counting::certain;
    references += certain ? d->references - d->uncertain : d->references;
    for (const JudgedClosure& c : d->closures) {
      if (certain && c.uncertain) continue;
      scored.push_back(
          {c.score, c.correct && (counting != Counting::with_right_pose || c.right_pose)});
    }
  }
  return precision_recall(std::move(scored), references);
}

void write_results(const std::filesystem::path& file, const Results& results) {
  Json json{{"benchmark_format", kVersion}, {"title", results.title}};
  Json made = Json::object();
  for (const auto& [key, value] : results.made) made[key] = value;
  json["made"] = made;
  json["results"] = Json::array();
  for (const Result& r : results.results) json["results"].push_back(to_json(r));
  json["gaps"] = Json::array();
  for (const Gap& g : results.gaps) json["gaps"].push_back({{"what", g.what}, {"why", g.why}});
  write_text_atomically(file, json.dump(1) + "\n");
}

Results read_results(const std::filesystem::path& file) {
  const Json json = Json::parse(read_text(file), nullptr, false);
  const std::string again = "; make it again with `groundloop benchmark`";
  if (json.is_discarded()) throw InputError(file.string() + ": no JSON" + again);
  try {
    if (json.at("benchmark_format").get<int>() != kVersion) {
      throw InputError(file.string() + ": results of another version" + again);
    }
    Results results;
    results.title = json.at("title").get<std::string>();
    for (const auto& [key, value] : json.at("made").items()) {
      results.made.emplace_back(key, value.get<std::string>());
    }
    for (const Json& r : json.at("results")) results.results.push_back(result_from(r));
    for (const Json& g : json.at("gaps")) {
      results.gaps.push_back({g.at("what").get<std::string>(), g.at("why").get<std::string>()});
    }
    return results;
  } catch (const Json::exception& e) {
    throw InputError(file.string() + ": " + e.what() + again);
  }
}

}  // namespace groundloop::apps
