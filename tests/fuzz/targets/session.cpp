// Whole session folders: read back, and their maps assembled.
#include "apps/commands/session_pieces.hpp"
#include "backend/map/map_assembly.hpp"
#include "backend/session/stored_session.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/sessions.hpp"

GROUNDLOOP_FUZZ_TARGET(session) {
  const StoredSession session =
      load_session(lay_out_session("session", text_of(input)), LoopClosureOptions{});
  FUZZ_PROMISE(!session.parts.empty());
  std::size_t maps = 0;
  for (const SessionPart& part : session.parts) {
    FUZZ_PROMISE(part.descriptions.size() == part.maps.size());
    FUZZ_PROMISE(part.odometry.size() == part.trajectory.size());
    for (const LocalMapRecord& map : part.maps) {
      FUZZ_PROMISE(map.first_scan <= map.last_scan && map.last_scan < part.trajectory.size());
      FUZZ_PROMISE(map.T_world_map.translation.allFinite());
    }
    maps += part.maps.size();
  }
  FUZZ_PROMISE(session.graph.vertices.size() == maps);
  for (const apps::SessionPieces pieces = apps::pieces_of(session.folder);
       const MapPiece& piece : pieces.pieces)
    (void)points_in_world(piece);
}
