// What a run leaves on the disk while it goes on, so that --resume goes on as if nothing had
// happened, whatever ended the run: the state of odometry, the unfinished local map, and what was
// found so far. One versioned, checksummed file that says which recording and configuration it
// belongs to.
#pragma once

#include "backend/mapping/run_state.hpp"
#include "backend/session/manifest.hpp"
#include "backend/session/session.hpp"

namespace groundloop {

/// "GCHECK08": the first eight bytes of a checkpoint; another version has another number.
inline constexpr std::uint64_t kCheckpointMagic = 0x38304b4345484347ULL;

class Checkpoint {
 public:
  Checkpoint(const SessionFolder& folder, const SessionIdentity& identity);

  [[nodiscard]] bool exists() const;
  /// Durable when it returns; the checkpoint before it stays until then.
  void save(const RunState& state) const;
  /// Puts the state of the checkpoint into one that was made with the same options. Throws
  /// InputError where the checkpoint is damaged or of another recording, configuration or version.
  void load(RunState& state, const LoopClosureOptions& options) const;

 private:
  std::filesystem::path file_;
  std::uint64_t identity_;
};

}  // namespace groundloop
