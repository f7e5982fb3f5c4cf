// The kept scans of a session, or its local maps, as pieces of its map: what export and evaluation
// assemble.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "backend/map/map_assembly.hpp"
#include "backend/session/session.hpp"

namespace groundloop::apps {

/// The recordings of a merged session that are in the first one's frame, each piece with the place
/// of its recording; a session of one recording has it whole.
struct SessionPieces {
  std::vector<MapPiece> pieces;
  std::size_t sessions = 1;
  std::size_t from_local_maps = 0;  ///< recordings that kept no scans
  std::vector<std::string> apart;  ///< recordings in frames of their own, which the map cannot hold
};

/// Throws InputError naming the file where the folder is no finished session.
[[nodiscard]] SessionPieces pieces_of(const SessionFolder& session);
/// The same with its scans, of a session of one recording, at other poses.
[[nodiscard]] SessionPieces pieces_of(const SessionFolder& session, const Trajectory& trajectory);

}  // namespace groundloop::apps
