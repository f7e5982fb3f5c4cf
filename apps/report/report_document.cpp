#include "apps/report/report_document.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "apps/report/closure_details.hpp"
#include "apps/report/closure_table.hpp"
#include "apps/report/map_blobs.hpp"
#include "apps/report/map_view.hpp"
#include "apps/report/scan_blobs.hpp"
#include "apps/report/session_verdict.hpp"
#include "apps/report/trajectory_evaluation_json.hpp"

namespace groundloop::apps {
namespace {

using Json = nlohmann::ordered_json;

std::string fixed(double value, int decimals) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

Json optional_json(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json optional_json(const std::optional<PoseDifference>& d) {
  return d ? Json{{"m", d->m}, {"deg", d->deg}} : Json();
}

Json optional_json(const std::optional<TrajectoryEvaluation>& e) {
  return e ? to_json(*e, TrajectoryEvaluationOptions{}) : Json();
}

Json closure_json(const SessionContents& contents, const ClosureRow& row) {
  const ClosureRecord& c = contents.session.closures[row.closure];
  return {{"id", row.closure},
          {"reference", {{"part", row.reference_part}, {"map", c.reference_map}}},
          {"query", {{"part", row.query_part}, {"map", c.query_map}}},
          {"reference_row", row.reference_row},
          {"query_row", row.query_row},
          {"source", to_string(c.source)},
          {"status", to_string(c.status)},
          {"matches", c.matches},
          {"inliers", c.inliers},
          {"overlap", optional_json(c.overlap)},
          {"rmse_m", optional_json(c.rmse)},
          {"one_frame", row.one_frame},
          {"error", optional_json(row.error)},
          {"residual", optional_json(row.residual)},
          {"correction", optional_json(row.correction)},
          {"moved", optional_json(row.moved)},
          {"deviation", optional_json(row.deviation)}};
}

// Of more than `most`, accepted ones and then those with most inliers, in the order of the file.
std::vector<ClosureRow> listed(const SessionContents& contents, const std::vector<ClosureRow>& all,
                               std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<ClosureRow> rows = all;
  std::stable_sort(rows.begin(), rows.end(), [&](const ClosureRow& a, const ClosureRow& b) {
    const ClosureRecord& ca = contents.session.closures[a.closure];
    const ClosureRecord& cb = contents.session.closures[b.closure];
    const bool accepted_a = ca.status == ClosureStatus::accepted;
    const bool accepted_b = cb.status == ClosureStatus::accepted;
    return accepted_a != accepted_b ? accepted_a : ca.inliers > cb.inliers;
  });
  rows.resize(most);
  std::sort(rows.begin(), rows.end(),
            [](const ClosureRow& a, const ClosureRow& b) { return a.closure < b.closure; });
  return rows;
}

Json strands_json(const SessionContents& contents, const ScanTable& table) {
  Json strands = Json::array();
  for (std::size_t s = 0; s < contents.strands.size(); ++s) {
    const Strand& strand = contents.strands[s];
    const StrandEvaluation& e = table.evaluations[s];
    strands.push_back({{"name", strand.name},
                       {"part", strand.part},
                       {"frame", strand.frame},
                       {"first_scan", strand.first_scan},
                       {"scans", strand.scans},
                       {"first_row", table.spans[s].first_row},
                       {"rows", table.spans[s].rows},
                       {"stride", table.spans[s].stride},
                       {"errors",
                        {{"odometry", optional_json(e.odometry)},
                         {"optimised", optional_json(e.optimised)},
                         {"joint", optional_json(e.joint)}}}});
  }
  return strands;
}

Json maps_json(const SessionContents& contents, const ScanTable& table) {
  Json maps = Json::array();
  for (std::size_t p = 0; p < contents.session.parts.size(); ++p) {
    for (const LocalMapRecord& map : contents.session.parts[p].maps) {
      const StrandScan first = strand_of(contents, p, map.first_scan);
      maps.push_back({{"part", p},
                      {"map", map.map},
                      {"row", table.row_of(first.strand, first.scan)},
                      {"scans", map.last_scan - map.first_scan + 1},
                      {"points", map.points}});
    }
  }
  return maps;
}

// What differs from the defaults first.
Json configuration_json(const Config& config) {
  const std::vector<ConfigEntry> defaults = list_config(Config());
  const std::vector<ConfigEntry> entries = list_config(config);
  std::vector<Json> rows;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const ConfigEntry& e = entries[i];
    rows.push_back({{"key", e.section + "." + e.key},
                    {"value", e.value},
                    {"default", defaults[i].value},
                    {"unit", e.unit},
                    {"allowed", e.allowed},
                    {"reason", e.reason}});
  }
  std::stable_partition(rows.begin(), rows.end(),
                        [](const Json& e) { return e["value"] != e["default"]; });
  return rows;
}

Json facts_json(const SessionContents& contents) {
  Json facts = Json::array();
  const Json& recording = contents.manifest.recording;
  if (recording.is_object()) {
    for (const auto& [key, value] : recording.items()) {
      if (key == "notes" || key == "warnings") continue;
      std::string text = value.is_string() ? value.get<std::string>() : value.dump();
      if (value.is_array()) {
        text.clear();
        for (const Json& v : value)
          text += (text.empty() ? "" : ", ") + (v.is_string() ? v.get<std::string>() : v.dump());
      }
      std::string name = key;
      std::replace(name.begin(), name.end(), '_', ' ');
      facts.push_back({name, text.empty() ? "not stated" : text});
    }
    for (const char* kind : {"warning", "note"}) {
      const std::string key = std::string(kind) + "s";
      if (!recording.contains(key)) continue;
      for (const Json& sentence : recording.at(key)) facts.push_back({kind, sentence});
    }
  }
  for (const ManifestPart& part : contents.manifest.parts)
    facts.push_back({"recording '" + part.name + "'", part.recording});
  for (const std::string& connection : contents.manifest.connections)
    facts.push_back({"connection", connection});
  facts.push_back({"groundloop", contents.manifest.identity.version});
  return facts;
}

double number_at(const Json& document, const char* pointer) {
  const Json::json_pointer place(pointer);
  if (!document.contains(place) || !document.at(place).is_number()) return 0.0;
  return document.at(place).get<double>();
}

void add_errors(const ScanTable& table, Page& document) {
  std::string before;
  std::string after;
  std::string joint;
  for (std::size_t s = 0; s < table.evaluations.size(); ++s) {
    const StrandEvaluation& e = table.evaluations[s];
    if (!e.optimised || !e.odometry) continue;
    const char* separator = before.empty() ? "" : ", ";
    before += separator + fixed(e.odometry->ape.translation_m.rmse, 2);
    after += separator + fixed(e.optimised->ape.translation_m.rmse, 2);
  }
  if (before.empty()) return;
  document.figures.emplace_back("position error, rmse", before + " → " + after + " m");
  if (table.evaluations.size() > 1 && !table.frames.empty() && table.frames.front()) {
    document.figures.emplace_back(
        "with one alignment for all",
        fixed(table.frames.front()->ape.translation_m.rmse, 2) + " m rmse");
  }
}

void add_figures(const SessionContents& contents, const ScanTable& table, Page& document) {
  const Json& metrics = contents.metrics;
  auto& figures = document.figures;
  double way = 0.0;
  std::size_t scans = 0;
  std::size_t accepted = 0;
  for (const SessionPart& part : contents.session.parts) {
    way += path_length(part.trajectory);
    scans += part.trajectory.size();
  }
  for (const ClosureRecord& c : contents.session.closures)
    accepted += c.status == ClosureStatus::accepted ? 1 : 0;
  figures.emplace_back("scans", std::to_string(scans));
  figures.emplace_back("path", fixed(way, 0) + " m");
  figures.emplace_back("closures accepted", std::to_string(accepted) + " of " +
                                                std::to_string(contents.session.closures.size()) +
                                                " candidates");
  add_errors(table, document);
  if (number_at(metrics, "/map_quality/pairs") > 0.0) {
    figures.emplace_back(
        "surfaces at revisits apart",
        fixed(number_at(metrics, "/map_quality/before/plane_thickness_m"), 3) + " → " +
            fixed(number_at(metrics, "/map_quality/after/plane_thickness_m"), 3) + " m");
  }
  if (const double total = number_at(metrics, "/timing_s/total"); total > 0.0)
    figures.emplace_back("time", fixed(total, 1) + " s");
  if (const double memory = number_at(metrics, "/peak_memory_mb"); memory > 0.0)
    figures.emplace_back("peak memory", fixed(memory, 0) + " MB");
}

std::string data_uri(const GreyPicture& picture) {
  return "data:image/png;base64," + base64(to_png(picture));
}

void add_frames(const SessionContents& contents, const ScanTable& table, const ReportLimits& limits,
                Page& document) {
  const std::vector<FrameView> views = make_map_views(contents, table, limits.points);
  Json frames = Json::array();
  for (std::size_t f = 0; f < views.size(); ++f) {
    const FrameView& view = views[f];
    const TopWindow& w = view.window;
    Json json{{"name", contents.frame_names[f]},
              {"low", {w.low.x(), w.low.y()}},
              {"pixel", w.pixel},
              {"width", w.width},
              {"height", w.height},
              {"odometry_picture", data_uri(view.odometry)},
              {"errors", optional_json(table.frames[f])}};
    if (!view.octree.points.empty()) json["cloud"] = map_blobs(view, document.blobs);
    frames.push_back(std::move(json));
    document.pictures.push_back({contents.frame_names[f], data_uri(view.optimised)});
  }
  document.json["frames"] = std::move(frames);
}

}  // namespace

ReportLimits report_limits(const ReportSection& section) {
  ReportLimits limits;
  limits.points = static_cast<std::size_t>(section.points);
  limits.closures = static_cast<std::size_t>(section.closures);
  return limits;
}

Page make_report_document(const SessionContents& contents, const std::vector<Trajectory>& truths,
                          const ReportLimits& limits) {
  Page document;
  const ScanTable table = make_scan_table(contents, truths, limits.rows);
  const std::vector<ClosureRow> rows = make_closure_rows(contents, table);
  document.verdict = judge_session(contents, table, rows);
  document.title = contents.merged()
                       ? std::to_string(contents.session.parts.size()) + " recordings in one map"
                       : contents.session.parts.front().recording;
  add_figures(contents, table, document);
  Json& json = document.json;
  json["kind"] = contents.merged() ? "merge" : "run";
  json["parts"] = Json::array();
  for (const SessionPart& part : contents.session.parts) json["parts"].push_back(part.name);
  json["scans"] = scan_blobs(contents, table, document.blobs);
  json["strands"] = strands_json(contents, table);
  json["maps"] = maps_json(contents, table);
  add_frames(contents, table, limits, document);
  Json closures = Json::array();
  for (const ClosureRow& row : listed(contents, rows, limits.listed))
    closures.push_back(closure_json(contents, row));
  json["closures"] = std::move(closures);
  json["closures_left_out"] = rows.size() - json["closures"].size();
  ClosureDetailLimits detail;
  detail.closures = limits.closures;
  detail.bytes = limits.closure_bytes;
  json["details"] = closure_details(contents, rows, document.blobs, detail);
  json["pieces"] = Json::array();
  for (const OdometryPiece& piece : contents.pieces) {
    json["pieces"].push_back({{"piece", piece.piece},
                              {"first_scan", piece.first_scan},
                              {"last_scan", piece.last_scan},
                              {"frame", piece.frame},
                              {"joined_by", piece.joined_by},
                              {"reason", piece.reason}});
  }
  json["metrics"] = contents.metrics;
  json["facts"] = facts_json(contents);
  json["configuration"] = configuration_json(contents.config);
  return document;
}

}  // namespace groundloop::apps
