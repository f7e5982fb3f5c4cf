// Session folders through the commands that read them. The first byte chooses the command.
#include <fstream>

#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/scratch_folder.hpp"
#include "tests/fuzz/targets/commands.hpp"
#include "tests/fuzz/targets/sessions.hpp"

GROUNDLOOP_FUZZ_TARGET(session_commands) {
  if (input.empty()) return;
  const std::string_view bundle = text_of(input.subspan(1));
  const std::string session = lay_out_session("session", bundle).string();
  const std::filesystem::path out = lay_out("out", {});
  switch (std::to_integer<char>(input.front())) {
    case 'e':
      (void)command({"export", session, "--out", (out / "map.pcd").string()});
      break;
    case 'l':
      (void)command({"export", session, "--out", (out / "map.las").string(), "--voxel", "0"});
      break;
    case 'm':
      (void)command({"match", session, lay_out_session("other", bundle).string(), "--out",
                     (out / "matches.csv").string()});
      break;
    case 'j':
      (void)command({"merge", session, lay_out_session("other", bundle).string(), "--out",
                     (out / "merged").string()});
      break;
    case 'c':
      (void)command(
          {"evaluate", "closures", session, "--ground-truth", session + "/odometry.tum", "--json"});
      break;
    case 'p':
      (void)command({"evaluate", "map", session, "--json"});
      break;
    default:
      (void)command({"evaluate", "trajectory", "--estimate", session + "/trajectory.tum",
                     "--ground-truth", session + "/odometry.tum", "--json"});
  }
}
