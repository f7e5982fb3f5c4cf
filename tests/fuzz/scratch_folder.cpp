#include "tests/fuzz/scratch_folder.hpp"

#include <algorithm>
#include <cstdlib>

#include <fcntl.h>
#include <unistd.h>

namespace groundloop::fuzz {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view kMark = "@@ ";
constexpr std::size_t kMostFiles = 64;
constexpr std::size_t kLongestName = 120;

class Scratch {
 public:
  Scratch() {
    std::error_code error;
    const fs::path memory = "/dev/shm";
    const bool usable = fs::is_directory(memory, error) && ::access(memory.c_str(), W_OK) == 0;
    std::string name = ((usable ? memory : fs::temp_directory_path()) / "fuzz.XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  ~Scratch() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

bool stays_inside(const std::string& name) {
  if (name.empty() || name.size() > kLongestName || name.find('\0') != std::string::npos)
    return false;
  const fs::path path(name);
  if (path.is_absolute() || !path.has_filename()) return false;
  const auto depth = std::distance(path.begin(), path.end());
  return depth <= 6 && std::none_of(path.begin(), path.end(), [](const fs::path& part) {
           return part == ".." || part == ".";
         });
}

void write(const fs::path& file, std::string_view content) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (fd < 0) return;  // a name that is a folder's, too
  while (!content.empty()) {
    const ssize_t written = ::write(fd, content.data(), content.size());
    if (written <= 0) std::abort();  // no room: nothing is tested any more
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  ::close(fd);
}

}  // namespace

const fs::path& scratch_folder() {
  static const Scratch scratch;
  return scratch.path();
}

fs::path scratch_file(const std::string& name, std::string_view content) {
  fs::path file = scratch_folder() / name;
  write(file, content);
  return file;
}

NamedContents split_bundle(std::string_view text) {
  NamedContents files;
  if (!text.starts_with(kMark)) return files;
  while (!text.empty() && files.size() < kMostFiles) {
    text.remove_prefix(kMark.size());
    const std::size_t line = std::min(text.find('\n'), text.size());
    std::string name(text.substr(0, line));
    text.remove_prefix(std::min(line + 1, text.size()));
    // The mark stands at the start of a line, that of the content included.
    std::size_t end = text.starts_with(kMark) ? 0 : text.find("\n" + std::string(kMark));
    end = std::min(end, text.size());
    if (stays_inside(name)) files.emplace_back(std::move(name), text.substr(0, end));
    text.remove_prefix(end);
    if (text.starts_with('\n')) text.remove_prefix(1);
  }
  return files;
}

std::string join_bundle(const std::vector<std::pair<std::string, std::string>>& files) {
  std::string text;
  for (const auto& [name, content] : files) {
    text += (text.empty() ? "" : "\n") + std::string(kMark) + name + "\n" + content;
  }
  return text;
}

fs::path lay_out(const std::string& name, const NamedContents& files) {
  const fs::path root = scratch_folder() / name;
  std::error_code error;
  fs::remove_all(root, error);
  fs::create_directories(root, error);
  for (const auto& [file, content] : files) {
    fs::create_directories((root / file).parent_path(), error);
    write(root / file, content);
  }
  return root;
}

}  // namespace groundloop::fuzz
