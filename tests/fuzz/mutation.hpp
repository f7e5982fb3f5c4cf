// Changes of an input that are the same on every machine: bytes and bits changed, parts cut out,
// repeated and put elsewhere, ends cut off, numbers in text and bytes replaced by extreme ones.
#pragma once

#include <cstdint>
#include <string>

namespace groundloop::fuzz {

/// The change number `seed` of `bytes`.
[[nodiscard]] std::string mutate(std::string bytes, std::uint64_t seed);

}  // namespace groundloop::fuzz
