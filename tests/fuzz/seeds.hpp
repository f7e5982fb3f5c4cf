// Inputs that a target accepts, made by the code of today: our own files as they are written now,
// others' by the writers of their layouts and byte by byte from the published formats. Fuzzing and
// the tests start from them and from those kept in corpus/.
#pragma once

#include <string>
#include <vector>

namespace groundloop::fuzz {

/// Empty where the target has only kept ones.
[[nodiscard]] std::vector<std::string> made_seeds(const std::string& target);

}  // namespace groundloop::fuzz
