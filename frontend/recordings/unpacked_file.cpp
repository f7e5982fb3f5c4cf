#include "frontend/recordings/unpacked_file.hpp"

#include <cerrno>
#include <cstdlib>

#include "frontend/core/error.hpp"
#include "frontend/core/output_file.hpp"
#include "frontend/recordings/compression.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

// A folder that only this user can enter, under a name that nobody can have taken before.
class PrivateFolder {
 public:
  PrivateFolder() {
    std::error_code error;
    const fs::path parent = fs::temp_directory_path(error);
    std::string name = (parent / "groundloop.XXXXXX").string();
    if (error || ::mkdtemp(name.data()) == nullptr) {
      throw InputError((error ? "the folder of temporary files" : parent.string()) +
                       ": cannot be written: " + write_error_text(error ? error.value() : errno) +
                       " (TMPDIR names another one)");
    }
    path_ = name;
  }
  ~PrivateFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

std::unique_ptr<MessageFile> open_unpacked(const fs::path& compressed, FileOpener open) {
  const PrivateFolder folder;
  const fs::path copy = folder.path() / compressed.stem();
  const bool whole = decompress_zstd_file(compressed, copy);
  auto file = open(copy);
  if (!whole) file->add_warning(compressed.filename().string() + " is cut off.");
  return file;
}

}  // namespace groundloop::recordings
