// Whether a result is to be trusted, as far as it can be told: what stands first in its report.
#pragma once

#include <string>
#include <vector>

namespace groundloop::apps {

enum class Trust {
  good,       ///< nothing was found against it
  careful,    ///< something to look at first
  untrusted,  ///< not to be used as it is
};
[[nodiscard]] const char* to_string(Trust trust);

struct Remark {
  Trust trust = Trust::good;
  std::string text;         ///< one sentence, naming the figure it rests on
  std::string advice = {};  ///< what to try; empty where there is nothing to try
};

struct Verdict {
  Trust trust = Trust::good;  ///< the worst of the remarks
  std::string headline;
  std::vector<Remark> remarks;  ///< the worst first
};

/// Of remarks in any order.
[[nodiscard]] Verdict make_verdict(std::vector<Remark> remarks);

}  // namespace groundloop::apps
