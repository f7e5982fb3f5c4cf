// One process at a time writes a folder. The lock is the kernel's and goes with its process,
// however that ends; nothing of it is left in the folder.
#pragma once

#include <filesystem>

#include "frontend/core/output_file.hpp"

namespace groundloop {

class FolderLock {
 public:
  FolderLock() = default;
  /// Throws InputError where another process holds the folder, or where it cannot be opened. File
  /// systems that know no locks are used without.
  explicit FolderLock(const std::filesystem::path& folder);

 private:
  FileDescriptor folder_;
};

}  // namespace groundloop
