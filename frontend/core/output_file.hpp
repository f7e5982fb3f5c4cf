// The one way groundloop writes: beside the final name, checked, made durable, then renamed. A name
// that can be seen holds a whole file, whatever happened: an error, a full disk, kill -9, power
// loss. What a killed process left behind is taken over by the next one that writes the same file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace groundloop {

/// An open file descriptor, closed with the object.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int fd) : fd_(fd) {}
  ~FileDescriptor() { close(); }
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(other.release()) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept;
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;

  [[nodiscard]] int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }
  void close();

 private:
  int release() {
    const int fd = fd_;
    fd_ = -1;
    return fd;
  }
  int fd_ = -1;
};

/// A file that appears under its final name only when commit() has succeeded. Destroyed before
/// that, it leaves nothing, and a file that was there before is untouched. All members throw
/// InputError, naming the final file, the reason and the remedy.
class OutputFile {
 public:
  /// Makes the folder where it is missing. Throws where the folder cannot be written, or where
  /// another process is writing the same file.
  explicit OutputFile(std::filesystem::path file);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(const void* data, std::size_t bytes);
  void write(std::string_view text) { write(text.data(), text.size()); }
  /// Overwrites the beginning, which has been written before: for headers that hold counts.
  void write_at_start(std::string_view bytes);
  /// Durable, then visible. On an error the final name is what it was.
  void commit();

  /// How the file is called until then: hidden, beside the final name.
  [[nodiscard]] static std::filesystem::path temporary_name(const std::filesystem::path& file);

 private:
  void flush();

  std::filesystem::path final_;
  std::filesystem::path temporary_;
  FileDescriptor fd_;
  std::vector<char> buffer_;
  std::uint64_t size_ = 0;
  bool committed_ = false;
};

void write_text_atomically(const std::filesystem::path& file, std::string_view text);

/// Puts the content of `from` under the name `to`, as a second name of the same file where the file
/// system allows it, else as a copy. Neither is written afterwards: files are replaced, not
/// changed. Call sync_folder once all are in place. Throws InputError.
void link_or_copy(const std::filesystem::path& from, const std::filesystem::path& to);

/// Bytes that are written once and read back, without a name: gone with the process, however it
/// ends. Throws InputError as OutputFile does.
class ScratchFile {
 public:
  explicit ScratchFile(const std::filesystem::path& folder);

  /// Returns the offset that the bytes were written at.
  std::uint64_t append(std::span<const std::byte> bytes);
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;

 private:
  std::filesystem::path folder_;
  FileDescriptor fd_;
  std::uint64_t size_ = 0;
};

/// Removes the temporary files that killed processes left in a folder; those that are being written
/// stay. Errors are ignored.
void remove_leftovers(const std::filesystem::path& folder);

/// Makes names in the folder durable: what was renamed, made or removed there.
void sync_folder(const std::filesystem::path& folder);

/// "No space left on device" and the like, with what mends it.
[[nodiscard]] std::string write_error_text(int error);

/// Bytes that a user may still write where `path` is or would be; the largest number where the file
/// system does not say.
[[nodiscard]] std::uint64_t free_space(std::filesystem::path path);

}  // namespace groundloop
