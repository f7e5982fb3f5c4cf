#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <spdlog/spdlog.h>

#include "apps/commands/commands.hpp"
#include "apps/commands/progress_bar.hpp"
#include "backend/map/map_assembly.hpp"
#include "backend/session/manifest.hpp"
#include "backend/session/session.hpp"
#include "frontend/core/error.hpp"

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

// How the local maps of a session lie: bent as its trajectory says, or, where a session holds no
// trajectories, each at its one pose.
class Layout {
 public:
  Layout(const SessionFolder& session, const std::vector<LocalMapRecord>& maps)
      : session_(session) {
    const fs::path odometry = session.file("odometry.tum");
    const fs::path trajectory = session.file("trajectory.tum");
    if (!fs::exists(odometry) || !fs::exists(trajectory)) return;
    odometry_ = read_tum(odometry);
    trajectory_ = read_tum(trajectory);
    for (const LocalMapRecord& map : maps) {
      if (map.first_scan <= map.last_scan &&
          map.last_scan < std::min(odometry_.size(), trajectory_.size()))
        continue;
      throw InputError(session.file("local_maps.csv").string() + ": map " +
                       std::to_string(map.map) +
                       " holds scans that odometry.tum or trajectory.tum do not; make the session "
                       "again");
    }
  }

  [[nodiscard]] MapPiece piece(const LocalMapRecord& map, std::uint16_t recording) const {
    const fs::path file = session_.local_map(map.map);
    if (trajectory_.empty()) return rigid_piece(file, map.T_world_map, recording);
    return bent_piece(file, map, odometry_, trajectory_, recording);
  }

 private:
  const SessionFolder& session_;
  Trajectory odometry_, trajectory_;
};

Pieces pieces_of(const SessionFolder& session) {
  Pieces result;
  const std::vector<LocalMapRecord> maps = read_local_maps(session.file("local_maps.csv"));
  const Layout layout(session, maps);
  const Manifest manifest = has_manifest(session) ? read_complete_manifest(session) : Manifest();
  if (!manifest.merged()) {
    for (const LocalMapRecord& map : maps) result.pieces.push_back(layout.piece(map, 0));
    return result;
  }
  result.sessions = manifest.parts.size();
  for (std::size_t p = 0; p < manifest.parts.size(); ++p) {
    const ManifestPart& part = manifest.parts[p];
    if (part.frame != manifest.parts.front().frame) {
      result.apart.push_back(part.name);
      continue;
    }
    const auto first = static_cast<int>(part.first_map);
    const int last = first + static_cast<int>(part.local_maps);
    for (const LocalMapRecord& map : maps) {
      if (map.map < first || map.map >= last) continue;
      result.pieces.push_back(layout.piece(map, static_cast<std::uint16_t>(p)));
    }
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
