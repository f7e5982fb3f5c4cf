// Detectors of others on a finished session, as `groundloop benchmark` runs them: the closures
// within it, or between two sessions, as a list that `groundloop evaluate closures --closures`
// judges.
//
//   groundloop_baselines scan_context|solid|std|btc SESSION [QUERY_SESSION] --out LIST.csv
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "frontend/core/error.hpp"
#include "tests/benchmarks/baselines/binary_triangles.hpp"
#include "tests/benchmarks/baselines/scan_context.hpp"
#include "tests/benchmarks/baselines/solid.hpp"
#include "tests/benchmarks/baselines/stable_triangles.hpp"

namespace groundloop::baselines {
namespace {

using Detector = MapPairs (*)(const SessionScans&, const SessionScans&);

int run(int count, char** arguments) {
  static const std::map<std::string, Detector> detectors{{"scan_context", detect_by_scan_context},
                                                         {"solid", detect_by_solid},
                                                         {"std", detect_by_std},
                                                         {"btc", detect_by_btc}};
  std::vector<std::string> words;
  std::string out;
  for (int i = 1; i < count; ++i) {
    const std::string argument = arguments[i];
    if (argument == "--out" && i + 1 < count) {
      out = arguments[++i];
    } else {
      words.push_back(argument);
    }
  }
  const auto detector = words.empty() ? detectors.end() : detectors.find(words[0]);
  if (detector == detectors.end() || words.size() < 2 || words.size() > 3 || out.empty()) {
    throw InputError(
        "usage: groundloop_baselines scan_context|solid|std|btc SESSION [QUERY_SESSION] --out "
        "LIST.csv");
  }
  const SessionScans references(words[1]);
  if (words.size() == 2) {
    detector->second(references, references).write(out);
  } else {
    detector->second(references, SessionScans(words[2])).write(out);
  }
  return 0;
}

}  // namespace
}  // namespace groundloop::baselines

int main(int count, char** arguments) {
  try {
    return groundloop::baselines::run(count, arguments);
  } catch (const groundloop::InputError& error) {
    std::fprintf(stderr, "groundloop_baselines: %s\n", error.what());
    return 2;
  }
}
