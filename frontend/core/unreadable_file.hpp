// A file that the system does not hand out: its permissions, its disk, the network. It may be there
// again tomorrow, unlike one whose content is wrong.
#pragma once

#include "frontend/core/error.hpp"

namespace groundloop {

/// Thrown where opening or reading fails; what the file holds is not known.
class UnreadableFile : public InputError {
 public:
  using InputError::InputError;
};

}  // namespace groundloop
