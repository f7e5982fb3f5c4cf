#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/commands.hpp"
#include "apps/progress_bar.hpp"
#include "backend/map_assembly.hpp"
#include "backend/session.hpp"
#include "frontend/core/error.hpp"

namespace groundloop::apps {
namespace fs = std::filesystem;

namespace {

struct Arguments {
  std::string session;
  std::string out;
  MapAssemblyOptions options;
};

void run(const Arguments& arguments, const Context& context) {
  const SessionFolder session{fs::path(arguments.session)};
  if (!fs::exists(session.file("local_maps.csv"))) {
    throw InputError(arguments.session +
                     ": is no session (local_maps.csv is missing); give a folder that `groundloop "
                     "run` or `merge` has finished");
  }
  std::vector<MapPiece> pieces;
  for (const LocalMapRecord& map : read_local_maps(session.file("local_maps.csv"))) {
    pieces.push_back({session.local_map(map.map), map.T_world_map, 0});
  }
  const fs::path out(arguments.out);
  const auto writer = open_point_cloud_writer(out, false);
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
