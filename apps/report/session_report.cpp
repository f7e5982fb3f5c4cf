#include "apps/report/session_report.hpp"

#include "apps/report/html_page.hpp"
#include "apps/report/report_document.hpp"

namespace groundloop::apps {

std::string make_session_report(const SessionContents& contents,
                                const std::vector<Trajectory>& truths) {
  return make_page(make_report_document(contents, truths, report_limits(contents.config.report)));
}

}  // namespace groundloop::apps
