#include "apps/report/verdict.hpp"

#include <algorithm>

namespace groundloop::apps {

const char* to_string(Trust trust) {
  switch (trust) {
    case Trust::good:
      return "good";
    case Trust::careful:
      return "careful";
    case Trust::untrusted:
      return "untrusted";
  }
  return "good";
}

Verdict make_verdict(std::vector<Remark> remarks) {
  std::stable_sort(remarks.begin(), remarks.end(),
                   [](const Remark& a, const Remark& b) { return a.trust > b.trust; });
  Verdict verdict;
  verdict.trust = remarks.empty() ? Trust::good : remarks.front().trust;
  switch (verdict.trust) {
    case Trust::good:
      verdict.headline = "Nothing was found against this result.";
      break;
    case Trust::careful:
      verdict.headline = "Usable with care: see what was found first.";
      break;
    case Trust::untrusted:
      verdict.headline = "This result is not to be trusted as it is.";
      break;
  }
  verdict.remarks = std::move(remarks);
  return verdict;
}

}  // namespace groundloop::apps
