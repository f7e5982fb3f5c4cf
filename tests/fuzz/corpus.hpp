// The inputs that a target starts from: those that the code of today makes and those kept in
// corpus/TARGET/.
#pragma once

#include <string>
#include <vector>

namespace groundloop::fuzz {

struct KeptInput {
  std::string name;
  std::string content;
  /// Made, or kept under a name that begins with "valid": the target must not refuse it.
  bool accepted = false;
};

[[nodiscard]] std::vector<KeptInput> corpus_of(const std::string& target);

}  // namespace groundloop::fuzz
