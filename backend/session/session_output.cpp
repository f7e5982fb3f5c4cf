#include "backend/session/session_output.hpp"

#include <algorithm>
#include <cerrno>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>

#include "frontend/core/checksum.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop {
namespace fs = std::filesystem;

namespace {

// In a folder that is to replace a session, until what it replaces has been cleared away.
constexpr const char* kReplacementMark = ".groundloop-replacement";

// The folder as it is, wherever a link or a relative name leads.
fs::path real_folder(const fs::path& path) {
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error).lexically_normal();
  const fs::path plain = absolute.has_filename() ? absolute : absolute.parent_path();
  const fs::path real = fs::canonical(plain, error);
  return error ? plain : real;
}

fs::path beside(const fs::path& target, const char* what) {
  return target.parent_path() / ("." + target.filename().string() + ".groundloop-" + what);
}

void remove_part_folders(const fs::path& sessions) {
  std::error_code error;
  for (const fs::directory_entry& part : fs::directory_iterator(sessions, error)) {
    for (const std::string& name : SessionFolder::part_files())
      fs::remove(part.path() / name, error);
    fs::remove(part.path(), error);
  }
  fs::remove(sessions, error);
}

// Local maps and scans have names of digits, matches of two numbers; other files in their folders
// stay.
void remove_numbered(const fs::path& folder, std::string_view extension) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() == extension &&
        stem.find_first_not_of("0123456789_") == std::string::npos)
      fs::remove(entry.path(), error);
  }
  fs::remove(folder, error);
}

// The first line in which two configurations differ, for a message.
std::string difference(const std::string& old_text, const std::string& new_text) {
  std::string_view a = old_text;
  std::string_view b = new_text;
  const auto line = [](std::string_view& rest) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view l = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    l = l.substr(0, l.find('#'));
    while (!l.empty() && l.back() == ' ') l.remove_suffix(1);
    while (!l.empty() && l.front() == ' ') l.remove_prefix(1);
    return l;
  };
  while (!a.empty() || !b.empty()) {
    const std::string_view la = line(a);
    const std::string_view lb = line(b);
    if (la != lb) return " ('" + std::string(la) + "' there, '" + std::string(lb) + "' now)";
  }
  return "";
}

// Throws unless the session in the folder is the one that would be made now.
void require_same(const SessionFolder& folder, const SessionIdentity& there,
                  const SessionIdentity& now, const std::string& configuration) {
  if (there == now) return;
  std::string what;
  if (there.command != now.command) {
    what = "was made by `groundloop " + there.command + "`";
  } else if (there.input != now.input) {
    what = "was made from other input (another recording, other scans of it, or other sessions)";
  } else if (there.configuration != now.configuration) {
    std::string old_text;
    try {
      old_text = read_text(folder.file("config.yaml"));
    } catch (const InputError&) {  // then without the detail
    }
    what = "was made with another configuration" +
           (old_text.empty() ? "" : difference(old_text, configuration));
  } else {
    what = "was made by groundloop " + there.version + ", this is " + now.version;
  }
  throw InputError(folder.path().string() + ": the session " + what +
                   "; it cannot be resumed as this one, choose another --out");
}

bool is_session_name(const std::string& name) {
  const auto in = [&](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  return in(SessionFolder::lasting_files()) || in(SessionFolder::other_files()) ||
         name == "local_maps" || name == "scans" || name == "matches" || name == "sessions";
}

// Files that are no session's, under another name where the new session has a file of that name.
void move_foreign_files(const fs::path& from, const fs::path& to) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(from, error)) {
    if (is_session_name(entry.path().filename().string())) continue;  // could not be removed
    fs::path destination = to / entry.path().filename();
    while (fs::exists(fs::symlink_status(destination, error))) destination += ".old";
    fs::rename(entry.path(), destination, error);
  }
  fs::remove(from, error);
}

bool marked(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / kReplacementMark, error);
}

// What a kill in the middle of replacing left is brought to its end.
void finish_replacing(const fs::path& target) {
  std::error_code error;
  const fs::path old = beside(target, "old");
  const fs::path fresh = beside(target, "new");
  if (!fs::exists(target, error) && fs::exists(old, error)) fs::rename(old, target, error);
  if (!marked(target)) return;
  // The new session is in place; what stands beside is the old one. The mark stays until that is
  // gone, so that what could not be moved this time is moved the next.
  bool gone = true;
  for (const fs::path& retired : {old, fresh}) {
    if (!fs::is_directory(retired, error)) continue;
    remove_session_files(SessionFolder(retired));
    move_foreign_files(retired, target);
    gone = gone && !fs::exists(retired, error);
  }
  if (gone) fs::remove(target / kReplacementMark, error);
}

}  // namespace

void remove_session_files(const SessionFolder& folder) {
  std::error_code error;
  // The manifest goes first: what is left without it is no session.
  fs::remove(folder.file("manifest.json"), error);
  for (const std::string& name : SessionFolder::lasting_files())
    fs::remove(folder.file(name), error);
  for (const std::string& name : SessionFolder::other_files()) fs::remove(folder.file(name), error);
  remove_numbered(folder.path() / "local_maps", ".pcd");
  remove_numbered(folder.path() / "scans", ".bin");
  remove_numbered(folder.path() / "matches", ".csv");
  remove_part_folders(folder.path() / "sessions");
  remove_leftovers(folder.path());
  fs::remove(folder.path(), error);
}

SessionOutput::SessionOutput(const fs::path& path, const SessionIdentity& identity,
                             const std::string& configuration, const SessionOutputOptions& options)
    : target_(real_folder(path)), identity_(identity), work_(target_) {
  std::error_code error;
  if (target_.filename().empty())
    throw InputError(path.string() + ": is no folder for a session; choose another --out");
  finish_replacing(target_);
  if (fs::exists(target_, error) && !fs::is_directory(target_, error))
    throw InputError(path.string() + ": is no folder; choose another --out");
  made_folder_ = fs::create_directories(target_, error);
  if (error) {
    throw InputError(path.string() + ": cannot be written: " + write_error_text(error.value()) +
                     "; choose another --out");
  }
  target_lock_ = FolderLock(target_);
  remove_leftovers(target_);
  if (!has_manifest(work_)) {
    if (!fs::is_empty(target_, error))
      throw InputError(path.string() + ": holds files that are no session; choose another --out");
    if (options.resume) {
      if (made_folder_) fs::remove(target_, error);
      throw InputError(path.string() +
                       ": there is no interrupted session to resume; run without --resume");
    }
    begin(configuration);
    return;
  }
  if (!is_session(work_)) {
    throw InputError(work_.file("manifest.json").string() +
                     ": is damaged, or no session's; move the folder away or choose another --out");
  }
  if (options.overwrite && !(options.resume && already_made())) {
    claim_beside(configuration, options.resume);
    return;
  }
  const Manifest there = read_manifest(work_);
  const bool complete = there.stage == SessionStage::complete;
  if (!options.resume) {
    throw InputError(
        path.string() +
        (complete ? ": holds a finished session; --overwrite replaces it, once the new one is "
                    "complete"
                  : ": holds an unfinished session; --resume goes on with it, --overwrite makes "
                    "another and replaces it once that is complete"));
  }
  require_same(work_, there.identity, identity_, configuration);
  go_on(there, configuration);
}

// A session with this identity is there, whole or not.
void SessionOutput::go_on(const Manifest& there, const std::string& configuration) {
  stage_ = there.stage;
  state_ = stage_ == SessionStage::complete ? State::finished : State::resumed;
  if (state_ == State::finished) {
    clear_unfinished();
  } else {
    write_text_atomically(work_.file("config.yaml"), configuration);
  }
}

void SessionOutput::clear_unfinished() {
  std::error_code error;
  fs::remove(work_.file("checkpoint.bin"), error);
  remove_numbered(work_.path() / "matches", ".csv");
}

// True where an earlier call has replaced the old session already, and nothing is left to go on
// with.
bool SessionOutput::already_made() const {
  if (marked(beside(target_, "new"))) return false;
  try {
    const Manifest there = read_manifest(work_);
    return there.stage == SessionStage::complete && there.identity == identity_;
  } catch (const InputError&) {
    return false;
  }
}

void SessionOutput::claim_beside(const std::string& configuration, bool resume) {
  std::error_code error;
  if (fs::equivalent(target_, fs::current_path(error), error)) {
    throw InputError(target_.string() +
                     ": is the folder you are in, which cannot be replaced; run from another one");
  }
  work_ = SessionFolder(beside(target_, "new"));
  if (fs::create_directory(work_.path(), error); error) {
    throw InputError(target_.string() + ": the new session cannot be written beside it: " +
                     write_error_text(error.value()) + "; choose another --out");
  }
  work_lock_ = FolderLock(work_.path());
  if (has_manifest(work_) && marked(work_.path())) {
    const Manifest there = read_manifest(work_);
    if (resume && there.identity == identity_) {
      go_on(there, configuration);
      if (state_ == State::finished) replace();
      return;
    }
  }
  // An earlier attempt that nobody goes on with.
  fs::remove(work_.path() / kReplacementMark, error);
  remove_session_files(work_);
  fs::create_directory(work_.path(), error);
  work_lock_ = FolderLock(work_.path());
  write_text_atomically(work_.path() / kReplacementMark, "");
  begin(configuration);
}

void SessionOutput::begin(const std::string& configuration) {
  // The manifest first: from then on the folder is a session's.
  reached(SessionStage::started);
  write_text_atomically(work_.file("config.yaml"), configuration);
}

void SessionOutput::reached(SessionStage stage) {
  Manifest manifest;
  manifest.stage = stage_ = stage;
  manifest.identity = identity_;
  write_manifest(work_, manifest);
}

void SessionOutput::complete(Manifest manifest) {
  manifest.stage = stage_ = SessionStage::complete;
  manifest.identity = identity_;
  write_manifest(work_, manifest);
  clear_unfinished();
  if (work_.path() != target_) replace();
}

void SessionOutput::replace() {
  const fs::path fresh = work_.path();
  sync_folder(fresh);
  if (::renameat2(AT_FDCWD, fresh.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) != 0) {
    // Not every file system exchanges: two steps then, which finish_replacing knows how to end.
    std::error_code error;
    const fs::path old = beside(target_, "old");
    fs::rename(target_, old, error);
    if (!error) {
      fs::rename(fresh, target_, error);
      std::error_code ignored;
      if (error) fs::rename(old, target_, ignored);
    }
    if (error) {
      throw InputError(target_.string() +
                       ": the old session cannot be replaced: " + write_error_text(error.value()) +
                       "; the new one is complete in " + fresh.string());
    }
  }
  sync_folder(target_.parent_path());
  finish_replacing(target_);
  work_ = SessionFolder(target_);
}

void SessionOutput::discard() {
  if (state_ != State::fresh) return;
  std::error_code error;
  fs::remove(work_.path() / kReplacementMark, error);
  const bool keep_folder = work_.path() == target_ && !made_folder_;
  remove_session_files(work_);
  if (keep_folder) fs::create_directory(target_, error);
}

}  // namespace groundloop
