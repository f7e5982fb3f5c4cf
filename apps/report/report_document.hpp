// Everything that the page of a session shows: its head in words, and one JSON document with the
// arrays it names, which the page's scripts draw. What is empty here has no place there.
#pragma once

#include <cstddef>
#include <vector>

#include "apps/report/html_page.hpp"
#include "apps/report/session_contents.hpp"

namespace groundloop::apps {

/// What a page may grow to, in parts: the whole stays under 20 MB whatever the session.
struct ReportLimits {
  std::size_t points = 1'000'000;       ///< of the 3-D view; some 7 bytes each
  std::size_t rows = 40'000;            ///< scans; of longer sessions every n-th is shown
  std::size_t listed = 5000;            ///< closures in the table, accepted ones first
  std::size_t closures = 60;            ///< closures with pictures and cross-sections
  std::size_t closure_bytes = 5 << 20;  ///< of those pictures, in base64
};
[[nodiscard]] ReportLimits report_limits(const ReportSection& section);

/// `truths` are one a recording, each in its own world, and may be empty. Throws InputError where
/// a local map cannot be read.
[[nodiscard]] Page make_report_document(const SessionContents& contents,
                                        const std::vector<Trajectory>& truths,
                                        const ReportLimits& limits);

}  // namespace groundloop::apps
