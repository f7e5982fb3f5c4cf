#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "apps/commands.hpp"
#include "apps/progress_bar.hpp"
#include "backend/map_assembly.hpp"
#include "backend/session.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"

namespace groundloop::apps {
namespace fs = std::filesystem;

namespace {

struct Arguments {
  std::string session;
  std::string out;
  MapAssemblyOptions options;
};

// The maps of a merged session that are in the first recording's frame, each with the place of its
// recording; a session of one recording has them all.
struct Pieces {
  std::vector<MapPiece> pieces;
  std::size_t sessions = 1;
  std::vector<std::string> apart;  // recordings in frames of their own, which the map cannot hold
};

Pieces pieces_of(const SessionFolder& session) {
  Pieces result;
  const std::vector<LocalMapRecord> maps = read_local_maps(session.file("local_maps.csv"));
  nlohmann::json parts;
  const fs::path manifest = session.file("manifest.json");
  if (fs::exists(manifest)) {
    try {
      parts = nlohmann::json::parse(read_text(manifest)).value("sessions", nlohmann::json());
    } catch (const nlohmann::json::exception&) {
      throw InputError(manifest.string() + ": damaged; make the session again");
    }
  }
  if (!parts.is_array() || parts.empty()) {
    for (const LocalMapRecord& map : maps)
      result.pieces.push_back({session.local_map(map.map), map.T_world_map, 0});
    return result;
  }
  result.sessions = parts.size();
  try {
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (parts[p].at("frame") != parts[0].at("frame")) {
        result.apart.push_back(parts[p].at("name").get<std::string>());
        continue;
      }
      const int first = parts[p].at("first_map").get<int>();
      const int last = first + parts[p].at("local_maps").get<int>();
      for (const LocalMapRecord& map : maps) {
        if (map.map < first || map.map >= last) continue;
        result.pieces.push_back(
            {session.local_map(map.map), map.T_world_map, static_cast<std::uint16_t>(p)});
      }
    }
  } catch (const nlohmann::json::exception&) {
    throw InputError(manifest.string() + ": damaged or of another version; merge again");
  }
  return result;
}

void run(const Arguments& arguments, const Context& context) {
  const SessionFolder session{fs::path(arguments.session)};
  if (!fs::exists(session.file("local_maps.csv"))) {
    throw InputError(arguments.session +
                     ": is no session (local_maps.csv is missing); give a folder that `groundloop "
                     "run` or `merge` has finished");
  }
  const auto [pieces, sessions, apart] = pieces_of(session);
  for (const std::string& name : apart) {
    spdlog::warn(
        "'{}' is not connected to the first recording and is left out; export its own "
        "session",
        name);
  }
  const fs::path out(arguments.out);
  const auto writer = open_point_cloud_writer(out, sessions > 1);
  stop_on_signals();
  const fs::path folder = out.has_parent_path() ? out.parent_path() : fs::path(".");
  const auto points =
      assemble_map(pieces, arguments.options, *writer, folder, make_progress(context));
  writer->finish();
  end_progress();
  if (!context.quiet) {
    std::printf("%s: %llu points of %zu local maps\n", arguments.out.c_str(),
                static_cast<unsigned long long>(points), pieces.size());
  }
}

}  // namespace

void add_export_command(CLI::App& app, Context& context) {
  CLI::App* command =
      app.add_subcommand("export", "write the optimised map of a session as PCD, PLY or LAS");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("session", arguments->session, "folder of a session")->required();
  command->add_option("--out", arguments->out, "file ending in .pcd, .ply or .las")->required();
  command
      ->add_option("--voxel", arguments->options.voxel_size,
                   "one point a voxel of this size, metres; 0 keeps every point")
      ->capture_default_str();
  command->callback([arguments, &context] { run(*arguments, context); });
}

}  // namespace groundloop::apps
