// The largest single allocation of this program since the last look, so that a size in a header
// that was believed is seen. Counts nothing under the sanitizers, which have limits of their own.
#pragma once

#include <cstddef>

namespace groundloop::fuzz {

/// The largest allocation by operator new since the last call, bytes.
[[nodiscard]] std::size_t take_largest_allocation();

}  // namespace groundloop::fuzz
