// Sessions in, one session out: what `groundloop merge` does around backend/session_merge, and
// `groundloop match`.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/commands/commands.hpp"
#include "apps/config/config.hpp"

namespace groundloop::apps {

struct MergeRequest {
  std::vector<std::filesystem::path> sessions;  ///< the first is the reference
  std::filesystem::path out;
  std::string fixed;                           ///< one of the sessions, by path or name, or empty
  std::vector<std::filesystem::path> matches;  ///< files of `groundloop match`
  std::map<std::string, std::filesystem::path> ground_truth;  ///< by recording
  Config config;
  bool overwrite = false;
  bool resume = false;  ///< go on with an unfinished merge in `out`: pairs matched stay matched
};

/// A session that cannot be used is named in a warning and left out. Throws InputError where fewer
/// than two are left or the one to hold is not among them.
void merge_recordings(const MergeRequest& request, Context& context);

struct MatchRequest {
  std::filesystem::path reference, query, out;  ///< no query: the closures within the reference
  bool anew =
      false;  ///< describe local maps with this configuration, not as the sessions have them
  Config config;
};

void match_recordings(const MatchRequest& request, const Context& context);

}  // namespace groundloop::apps
