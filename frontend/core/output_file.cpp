#include "frontend/core/output_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"

namespace groundloop {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kBuffer = 1 << 18;
constexpr std::string_view kLeftover = ".groundloop-part";

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

[[noreturn]] void fail(const fs::path& file, const std::string& what, int error) {
  throw InputError(file.string() + ": " + what + ": " + write_error_text(error));
}

void write_all(int fd, const char* data, std::size_t bytes, const fs::path& file) {
  while (bytes > 0) {
    const ssize_t written = ::write(fd, data, bytes);
    if (written < 0 && errno == EINTR) continue;
    // Nothing written without an error: the disk is full to the byte.
    if (written <= 0) fail(file, "cannot be written whole", written < 0 ? errno : ENOSPC);
    data += written;
    bytes -= static_cast<std::size_t>(written);
  }
}

bool is_leftover(const fs::path& file) {
  const std::string name = file.filename().string();
  return name.size() > kLeftover.size() && name.front() == '.' && name.ends_with(kLeftover);
}

// Opens a temporary file for writing alone. One that a killed process left is taken over; one that
// a living process holds locked is not.
FileDescriptor open_alone(const fs::path& temporary, const fs::path& final) {
  // A file may be renamed or removed by another process between open and lock: then again.
  for (int attempt = 0; attempt < 100; ++attempt) {
    FileDescriptor fd(
        ::open(temporary.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666));
    if (!fd) fail(final, "cannot be written", errno);
    struct stat status {};
    if (::fstat(fd.get(), &status) != 0 || !S_ISREG(status.st_mode))
      fail(final, "cannot be written beside " + temporary.string(), EEXIST);
    if (::flock(fd.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      throw InputError(final.string() +
                       ": is being written by another process; wait for it to end");
    }
    struct stat named {};
    if (::stat(temporary.c_str(), &named) != 0 || named.st_ino != status.st_ino) continue;
    if (::ftruncate(fd.get(), 0) != 0) fail(final, "cannot be written", errno);
    return fd;
  }
  fail(final, "cannot be written", EBUSY);
}

}  // namespace

FileDescriptor& FileDescriptor::operator=(FileDescriptor&& other) noexcept {
  if (this != &other) {
    close();
    fd_ = other.release();
  }
  return *this;
}

void FileDescriptor::close() {
  if (fd_ >= 0) ::close(release());
}

std::string write_error_text(int error) {
  std::string text = std::strerror(error);
  if (error == ENOSPC || error == EDQUOT) return text + "; make room on the disk";
  if (error == EACCES || error == EPERM || error == EROFS)
    return text + "; choose a folder you may write to";
  if (error == ENAMETOOLONG) return text + "; choose a shorter name";
  return text;
}

fs::path OutputFile::temporary_name(const fs::path& file) {
  return folder_of(file) / ("." + file.filename().string() + std::string(kLeftover));
}

OutputFile::OutputFile(fs::path file)
    : final_(std::move(file)), temporary_(temporary_name(final_)) {
  if (!final_.has_filename()) throw InputError("'" + final_.string() + "' is no name of a file");
  std::error_code error;
  if (fs::is_directory(final_, error))
    throw InputError(final_.string() + ": is a folder; choose another name");
  error.clear();
  if (final_.has_parent_path()) fs::create_directories(final_.parent_path(), error);
  if (error) fail(final_, "its folder cannot be made", error.value());
  fd_ = open_alone(temporary_, final_);
  buffer_.reserve(kBuffer);
}

OutputFile::~OutputFile() {
  if (committed_) return;
  ::unlink(temporary_.c_str());
}

void OutputFile::write(const void* data, std::size_t bytes) {
  const char* from = static_cast<const char*>(data);
  size_ += bytes;
  if (buffer_.size() + bytes > kBuffer) flush();
  if (bytes > kBuffer) {
    write_all(fd_.get(), from, bytes, final_);
  } else {
    buffer_.insert(buffer_.end(), from, from + bytes);
  }
}

void OutputFile::write_at_start(std::string_view bytes) {
  flush();
  check(bytes.size() <= size_, "a header is written over what was written");
  if (::lseek(fd_.get(), 0, SEEK_SET) != 0) fail(final_, "cannot be written", errno);
  write_all(fd_.get(), bytes.data(), bytes.size(), final_);
  if (::lseek(fd_.get(), 0, SEEK_END) < 0) fail(final_, "cannot be written", errno);
}

void OutputFile::flush() {
  write_all(fd_.get(), buffer_.data(), buffer_.size(), final_);
  buffer_.clear();
}

void OutputFile::commit() {
  flush();
  // Some file systems tell of a full disk only here.
  if (::fsync(fd_.get()) != 0) fail(final_, "cannot be written whole", errno);
  if (::rename(temporary_.c_str(), final_.c_str()) != 0)
    fail(final_, "cannot be put in place", errno);
  committed_ = true;
  fd_.close();
  sync_folder(folder_of(final_));
}

void write_text_atomically(const fs::path& file, std::string_view text) {
  OutputFile out(file);
  out.write(text);
  out.commit();
}

void link_or_copy(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directories(folder_of(to), error);
  if (error) fail(to, "its folder cannot be made", error.value());
  if (fs::equivalent(from, to, error)) return;  // linked before
  fs::remove(to, error);
  fs::create_hard_link(from, to, error);
  if (!error) return;
  OutputFile out(to);
  std::uintmax_t size = 0;
  std::ifstream in = open_for_reading(from, size);
  std::vector<char> buffer(kBuffer);
  while (in) {
    in.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    out.write(buffer.data(), static_cast<std::size_t>(in.gcount()));
  }
  out.commit();
}

ScratchFile::ScratchFile(const fs::path& folder) : folder_(folder) {
  fd_ = FileDescriptor(::open(folder.c_str(), O_RDWR | O_TMPFILE | O_CLOEXEC, 0600));
  if (fd_) return;
  // File systems without unnamed files: a name, and at once none.
  std::string name = (folder / (".scratch-XXXXXX" + std::string(kLeftover))).string();
  fd_ = FileDescriptor(::mkstemps(name.data(), static_cast<int>(kLeftover.size())));
  if (!fd_) fail(folder, "cannot be written", errno);
  ::unlink(name.c_str());
}

std::uint64_t ScratchFile::append(std::span<const std::byte> bytes) {
  const std::uint64_t at = size_;
  write_all(fd_.get(), reinterpret_cast<const char*>(bytes.data()), bytes.size(), folder_);
  size_ += bytes.size();
  return at;
}

void ScratchFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::pread(fd_.get(), bytes.data() + done, bytes.size() - done,
                                static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) fail(folder_, "what was written cannot be read back", got < 0 ? errno : EIO);
    done += static_cast<std::size_t>(got);
  }
}

void remove_leftovers(const fs::path& folder) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (!is_leftover(entry.path()) || !entry.is_regular_file(error)) continue;
    const FileDescriptor fd(::open(entry.path().c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW));
    if (!fd || ::flock(fd.get(), LOCK_EX | LOCK_NB) != 0) continue;
    ::unlink(entry.path().c_str());
  }
}

void sync_folder(const fs::path& folder) {
  const FileDescriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!fd) return;  // a folder that may be written but not read: nothing to ask it for
  // Some file systems cannot: what was renamed is then as durable as they make it.
  if (::fsync(fd.get()) != 0 && errno != EINVAL && errno != ENOTSUP && errno != EROFS)
    fail(folder, "cannot be written", errno);
}

std::uint64_t free_space(fs::path path) {
  std::error_code error;
  path = fs::absolute(path, error);
  while (!fs::exists(path, error) && path.has_relative_path()) path = path.parent_path();
  const fs::space_info space = fs::space(path, error);
  return error ? std::numeric_limits<std::uint64_t>::max() : space.available;
}

}  // namespace groundloop
