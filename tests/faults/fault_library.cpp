// Loaded before the C library (LD_PRELOAD), it makes one operation of a process fail, or kills the
// process before it: GROUNDLOOP_FAULT=KIND:N:WHAT, the N-th (from 1) operation of a kind below
// GROUNDLOOP_FAULT_ROOT, with WHAT an error (ENOSPC, EIO, EACCES) or "kill". Kinds: open, write,
// fsync, rename, link, unlink, mkdir, read, alloc; "any" is every one that changes the disk.
// GROUNDLOOP_FAULT_COUNTS names a file that the counts go to when the process ends.
//
// Writes that fail are first done by half: what a full disk does.

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

namespace {

enum Kind { kOpen, kWrite, kFsync, kRename, kLink, kUnlink, kMkdir, kRead, kAlloc, kAny, kKinds };
const char* const kNames[kKinds] = {"open",   "write", "fsync", "rename", "link",
                                    "unlink", "mkdir", "read",  "alloc",  "any"};

std::atomic<long> counts[kKinds];
Kind fault_kind = kKinds;
long fault_number = 0;
int fault_error = 0;  // 0: kill
char root[4096];
bool ready = false;

template <typename F>
F next(const char* name) {
  return reinterpret_cast<F>(dlsym(RTLD_NEXT, name));
}

bool below_root(const char* path) {
  return path != nullptr && root[0] != '\0' && std::strncmp(path, root, std::strlen(root)) == 0;
}

bool below_root(int fd) {
  char link[64];
  char path[4096];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length <= 0) return false;
  path[length] = '\0';
  return below_root(path);
}

// True where this operation is the one that fails; errno is set. Does not return where it kills.
bool fails(Kind kind) {
  const long number = ++counts[kind];
  const bool changes = kind != kRead && kind != kAlloc;
  const long any = changes ? ++counts[kAny] : 0;
  const bool hit = (fault_kind == kind && number == fault_number) ||
                   (fault_kind == kAny && changes && any == fault_number);
  if (!hit) return false;
  if (fault_error == 0) {
    raise(SIGKILL);
  }
  errno = fault_error;
  return true;
}

__attribute__((constructor)) void set_up() {
  if (const char* where = std::getenv("GROUNDLOOP_FAULT_ROOT"))
    std::snprintf(root, sizeof root, "%s", where);
  if (const char* fault = std::getenv("GROUNDLOOP_FAULT")) {
    char kind[16] = {}, what[16] = {};
    if (std::sscanf(fault, "%15[^:]:%ld:%15s", kind, &fault_number, what) == 3) {
      for (int k = 0; k < kKinds; ++k) {
        if (std::strcmp(kind, kNames[k]) == 0) fault_kind = static_cast<Kind>(k);
      }
      fault_error = std::strcmp(what, "ENOSPC") == 0   ? ENOSPC
                    : std::strcmp(what, "EIO") == 0    ? EIO
                    : std::strcmp(what, "EACCES") == 0 ? EACCES
                    : std::strcmp(what, "ENOMEM") == 0 ? ENOMEM
                                                       : 0;
    }
  }
  ready = true;
}

__attribute__((destructor)) void tell_counts() {
  const char* file = std::getenv("GROUNDLOOP_FAULT_COUNTS");
  if (file == nullptr) return;
  ready = false;
  const int fd =
      next<int (*)(const char*, int, ...)>("open")(file, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  for (int k = 0; k < kKinds; ++k) dprintf(fd, "%s %ld\n", kNames[k], counts[k].load());
  close(fd);
}

bool for_writing(int flags) { return (flags & O_ACCMODE) != O_RDONLY || (flags & O_CREAT) != 0; }

template <typename F>
int open_with(const char* name, const char* path, int flags, mode_t mode) {
  if (ready && below_root(path) && for_writing(flags) && fails(kOpen)) return -1;
  return next<F>(name)(path, flags, mode);
}

mode_t mode_of(int flags, va_list arguments) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? static_cast<mode_t>(va_arg(arguments, unsigned))
                                              : 0;
}

// Large allocations only: the small ones of the run-time library are not what memory ends with.
constexpr std::size_t kLarge = 64 * 1024;
bool allocation_fails(std::size_t size) { return ready && size >= kLarge && fails(kAlloc); }

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return open_with<int (*)(const char*, int, ...)>("open", path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return open_with<int (*)(const char*, int, ...)>("open64", path, flags, mode);
}

FILE* fopen(const char* path, const char* mode) {
  if (ready && below_root(path) && mode[0] != 'r' && fails(kOpen)) return nullptr;
  return next<FILE* (*)(const char*, const char*)>("fopen")(path, mode);
}

FILE* fopen64(const char* path, const char* mode) {
  if (ready && below_root(path) && mode[0] != 'r' && fails(kOpen)) return nullptr;
  return next<FILE* (*)(const char*, const char*)>("fopen64")(path, mode);
}

ssize_t write(int fd, const void* data, std::size_t bytes) {
  const auto real = next<ssize_t (*)(int, const void*, std::size_t)>("write");
  if (ready && below_root(fd) && fails(kWrite)) {
    const int error = errno;
    if (error == ENOSPC && bytes > 1) (void)!real(fd, data, bytes / 2);
    errno = error;
    return -1;
  }
  return real(fd, data, bytes);
}

ssize_t writev(int fd, const struct iovec* parts, int count) {
  if (ready && below_root(fd) && fails(kWrite)) return -1;
  return next<ssize_t (*)(int, const struct iovec*, int)>("writev")(fd, parts, count);
}

ssize_t pread(int fd, void* data, std::size_t bytes, off_t offset) {
  if (ready && below_root(fd) && fails(kRead)) return -1;
  return next<ssize_t (*)(int, void*, std::size_t, off_t)>("pread")(fd, data, bytes, offset);
}

ssize_t read(int fd, void* data, std::size_t bytes) {
  if (ready && below_root(fd) && fails(kRead)) return -1;
  return next<ssize_t (*)(int, void*, std::size_t)>("read")(fd, data, bytes);
}

int fsync(int fd) {
  if (ready && below_root(fd) && fails(kFsync)) return -1;
  return next<int (*)(int)>("fsync")(fd);
}

int ftruncate(int fd, off_t length) {
  if (ready && below_root(fd) && fails(kWrite)) return -1;
  return next<int (*)(int, off_t)>("ftruncate")(fd, length);
}

int rename(const char* from, const char* to) {
  if (ready && below_root(to) && fails(kRename)) return -1;
  return next<int (*)(const char*, const char*)>("rename")(from, to);
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  if (ready && below_root(to) && fails(kRename)) return -1;
  return next<int (*)(int, const char*, int, const char*, unsigned)>("renameat2")(
      from_folder, from, to_folder, to, flags);
}

int link(const char* from, const char* to) {
  if (ready && below_root(to) && fails(kLink)) return -1;
  return next<int (*)(const char*, const char*)>("link")(from, to);
}

int unlink(const char* path) {
  if (ready && below_root(path) && fails(kUnlink)) return -1;
  return next<int (*)(const char*)>("unlink")(path);
}

int remove(const char* path) {
  if (ready && below_root(path) && fails(kUnlink)) return -1;
  return next<int (*)(const char*)>("remove")(path);
}

int mkdir(const char* path, mode_t mode) {
  if (ready && below_root(path) && fails(kMkdir)) return -1;
  return next<int (*)(const char*, mode_t)>("mkdir")(path, mode);
}

void* malloc(std::size_t size) {
  static const auto real = next<void* (*)(std::size_t)>("malloc");
  if (allocation_fails(size)) return nullptr;
  return real(size);
}

int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  if (allocation_fails(size)) return ENOMEM;
  return next<int (*)(void**, std::size_t, std::size_t)>("posix_memalign")(memory, alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  if (allocation_fails(size)) return nullptr;
  return next<void* (*)(std::size_t, std::size_t)>("aligned_alloc")(alignment, size);
}

}  // extern "C"
