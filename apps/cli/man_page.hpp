// Manual pages in section 1, in the man macros of roff (man-pages(7)).
#pragma once

#include <string>

#include "apps/cli/command_page.hpp"

namespace groundloop::apps {

/// "groundloop-evaluate-map.1"
[[nodiscard]] std::string man_page_name(const CommandPage& page);

/// The page as roff.
[[nodiscard]] std::string man_page(const CommandPage& page);

}  // namespace groundloop::apps
