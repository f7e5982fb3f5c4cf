#include "backend/session/folder_lock.hpp"

#include <cerrno>

#include <fcntl.h>
#include <sys/file.h>

#include "frontend/core/error.hpp"

namespace groundloop {

FolderLock::FolderLock(const std::filesystem::path& folder)
    : folder_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (!folder_) {
    throw InputError(folder.string() + ": cannot be opened: " + write_error_text(errno));
  }
  if (::flock(folder_.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    throw InputError(folder.string() +
                     ": another groundloop writes this session; wait for it to end or choose "
                     "another --out");
  }
}

}  // namespace groundloop
