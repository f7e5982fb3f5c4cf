#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <spdlog/spdlog.h>

#include "apps/commands/commands.hpp"
#include "apps/commands/export_poses.hpp"
#include "apps/commands/progress_bar.hpp"
#include "apps/commands/session_pieces.hpp"
#include "backend/map/map_assembly.hpp"
#include "backend/session/session.hpp"
#include "frontend/core/error.hpp"

namespace groundloop::apps {
namespace fs = std::filesystem;

namespace {

struct Arguments {
  std::string session;
  std::string out;
  MapAssemblyOptions options;
  PoseExport poses;
};

void run_poses(PoseExport request, const Arguments& arguments, const Context& context) {
  request.session = arguments.session;
  request.out = arguments.out;
  const std::size_t poses = export_poses(request);
  if (!context.quiet) std::printf("%s: %zu poses\n", arguments.out.c_str(), poses);
}

void run(const Arguments& arguments, const Context& context) {
  if (fs::path(arguments.out).extension() == ".csv") {
    run_poses(arguments.poses, arguments, context);
    return;
  }
  if (arguments.poses.uncertainty || arguments.poses.from || arguments.poses.to)
    throw InputError(
        "--uncertainty, --from and --to are of poses; give --out a name ending in .csv");
  const SessionFolder session{fs::path(arguments.session)};
  const auto [pieces, sessions, from_local_maps, apart] = pieces_of(session);
  for (const std::string& name : apart) {
    spdlog::warn(
        "'{}' is not connected to the first recording and is left out; export its own "
        "session",
        name);
  }
  const fs::path out(arguments.out);
  const auto writer = open_point_cloud_writer(out, fields_of(pieces, sessions > 1));
  stop_on_signals();
  const fs::path folder = out.has_parent_path() ? out.parent_path() : fs::path(".");
  const auto points =
      assemble_map(pieces, arguments.options, *writer, folder, make_progress(context));
  writer->finish();
  end_progress();
  if (from_local_maps > 0) {
    spdlog::info(
        "{} of {} recordings kept no scans: their part of the map is put together from local maps, "
        "as odometry built them",
        from_local_maps, sessions);
  }
  if (!context.quiet) {
    std::printf("%s: %llu points of %zu files of scans or local maps\n", arguments.out.c_str(),
                static_cast<unsigned long long>(points), pieces.size());
  }
}

}  // namespace

void add_export_command(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand(
      "export", "write the optimised map of a session as PCD, PLY or LAS, or its poses as CSV");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("SESSION", arguments->session, "folder of a session")->required();
  command
      ->add_option("--out", arguments->out,
                   "file ending in .pcd, .ply or .las, or in .csv for poses")
      ->required();
  command
      ->add_option("--voxel", arguments->options.voxel_size,
                   "one point a voxel of this size, metres; 0 keeps every point")
      ->capture_default_str();
  command->add_flag("--uncertainty", arguments->poses.uncertainty,
                    "with standard deviations and covariance of every pose against the first, "
                    "perturbed on the right, metres and radians");
  command->add_option("--from", arguments->poses.from,
                      "with --to: the pose of one scan in another");
  command->add_option("--to", arguments->poses.to, "number of the other scan");
  command->callback([arguments, &context] { run(*arguments, context); });
}

}  // namespace groundloop::apps
