// The local maps of a session as pieces of its map: what export and evaluation assemble.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "backend/map/map_assembly.hpp"
#include "backend/session/session.hpp"

namespace groundloop::apps {

/// The maps of a merged session that are in the first recording's frame, each with the place of its
/// recording; a session of one recording has them all.
struct SessionPieces {
  std::vector<MapPiece> pieces;
  std::size_t sessions = 1;
  std::vector<std::string> apart;  ///< recordings in frames of their own, which the map cannot hold
};

/// Throws InputError naming the file where the folder is no finished session.
[[nodiscard]] SessionPieces pieces_of(const SessionFolder& session);

}  // namespace groundloop::apps
