// The folder that a run or a merge writes its session to, from the first look at it to the finished
// session. Nothing that the run did not make itself is ever removed: a folder of other files is
// refused; one that holds a session is refused unless it is to be overwritten, and then the old
// session stays until the new one is complete.
//
//   SessionOutput out(path, identity, {.resume = true});
//   if (out.state() == SessionOutput::State::finished) return;   // nothing to do
//   ... write to out.folder() ...
//   out.complete(manifest);
#pragma once

#include <filesystem>

#include "backend/session/folder_lock.hpp"
#include "backend/session/manifest.hpp"
#include "backend/session/session.hpp"

namespace groundloop {

struct SessionOutputOptions {
  bool overwrite = false;
  bool resume = false;
};

class SessionOutput {
 public:
  enum class State {
    fresh,     ///< nothing is there yet
    resumed,   ///< an unfinished session with the same identity is there
    finished,  ///< a complete session with the same identity is there; it stays as it is
  };

  /// Claims the folder `path`, with `configuration` (the text of config.yaml) and `identity` as
  /// what is about to be made, and writes a manifest that says so. Throws InputError where the
  /// folder is no session's, where it holds a session and neither option allows to go on, where the
  /// session to resume was made of other input, configuration or version (naming what differs),
  /// where another process writes it, or where it cannot be written.
  SessionOutput(const std::filesystem::path& path, const SessionIdentity& identity,
                const std::string& configuration, const SessionOutputOptions& options);

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] const SessionIdentity& identity() const { return identity_; }
  /// The stage that a resumed session had reached.
  [[nodiscard]] SessionStage stage() const { return stage_; }
  /// Where to write: the folder itself, or the place beside it that replaces it in the end.
  [[nodiscard]] const SessionFolder& folder() const { return work_; }

  /// Says in the manifest that a stage is finished.
  void reached(SessionStage stage);
  /// Writes the manifest of the complete session, whose stage and identity are set here, removes
  /// what only an unfinished session needs, and takes the place of the old session where there was
  /// one.
  void complete(Manifest manifest);
  /// Removes what this run made, unless it was resumed: after an error before anything worth
  /// keeping was made.
  void discard();

 private:
  [[nodiscard]] bool already_made() const;
  void claim_beside(const std::string& configuration, bool resume);
  void begin(const std::string& configuration);
  void go_on(const Manifest& there, const std::string& configuration);
  void clear_unfinished();
  void replace();

  std::filesystem::path target_;
  SessionIdentity identity_;
  SessionFolder work_;
  FolderLock target_lock_, work_lock_;
  State state_ = State::fresh;
  SessionStage stage_ = SessionStage::started;
  bool made_folder_ = false;
};

/// Removes the files of a session from a folder, and the folder where it is empty then. Other files
/// stay.
void remove_session_files(const SessionFolder& folder);

}  // namespace groundloop
