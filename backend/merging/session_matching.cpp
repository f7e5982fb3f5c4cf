#include "backend/merging/session_matching.hpp"

#include <algorithm>
#include <string_view>

#include "backend/session/table_row.hpp"
#include "frontend/core/checksum.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "loopclosure/loop_database.hpp"

namespace groundloop {
namespace {

constexpr std::string_view kFirstLine = "# groundloop matches 1";
constexpr std::string_view kPair = "# pair,";
constexpr std::string_view kEnd = "# end ";
constexpr std::size_t kInformationFields = 21;

std::string matches_header() {
  std::string text = closure_header();
  for (int i = 1; i <= 6; ++i) {
    for (int j = i; j <= 6; ++j) text += ",i" + std::to_string(i) + std::to_string(j);
  }
  return text;
}

std::string information_fields(const Matrix6d& information) {
  std::string text;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) text += "," + to_text(information(i, j));
  }
  return text;
}

Matrix6d information_from(const TableRow& row) {
  Matrix6d information;
  std::size_t field = kClosureFields;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) information(i, j) = information(j, i) = row.number(field++);
  }
  return information;
}

}  // namespace

PairMatches match_parts(const SessionPart& reference, MapStore& references,
                        const SessionPart& query, MapStore& queries,
                        const SessionMatchingOptions& options, LoopClosureTimes* times,
                        const Progress& progress) {
  PairMatches result{reference.name, query.name, reference.fingerprint, query.fingerprint, {}};
  // Structure seen by another LiDAR, or years later, agrees less. Sessions are joined by closures
  // that agree with each other over both odometries only: the second witness that few inliers lack.
  VerificationOptions verification = options.verification;
  verification.min_agreement = std::min(verification.min_agreement, verification.vouched_agreement);
  verification.between_sessions = true;
  LoopDatabase database(options.loop_closure);
  for (MapDescription description : reference.descriptions) {
    description.key.session = 0;
    database.insert(std::move(description));
  }
  for (std::size_t m = 0; m < query.descriptions.size(); ++m) {
    if (progress) progress("matching sessions", m, query.descriptions.size());
    MapDescription description = query.descriptions[m];
    description.key.session = 1;
    for (const ClosureCandidate& candidate : database.query(description, times)) {
      ClosureRecord closure =
          verify_candidate(candidate, queries, query.first_map + candidate.query.map, references,
                           reference.first_map + candidate.reference.map, options.closures,
                           verification, options.registration);
      closure.reference_session = reference.name;
      closure.query_session = query.name;
      result.closures.push_back(std::move(closure));
    }
  }
  return result;
}

void write_matches(const std::filesystem::path& file, const std::vector<PairMatches>& pairs) {
  std::string text = std::string(kFirstLine) + "\n";
  for (const PairMatches& pair : pairs) {
    text += std::string(kPair) + quoted(pair.reference) + "," +
            std::to_string(pair.reference_fingerprint) + "," + quoted(pair.query) + "," +
            std::to_string(pair.query_fingerprint) + "\n";
  }
  text += matches_header() + "\n";
  for (const PairMatches& pair : pairs) {
    for (const ClosureRecord& c : pair.closures)
      text += closure_row(c) + information_fields(c.information) + "\n";
  }
  text += std::string(kEnd) + std::to_string(checksum(std::string_view(text))) + "\n";
  write_text_atomically(file, text);
}

std::vector<PairMatches> read_matches(const std::filesystem::path& file) {
  const std::string text = read_text(file);
  if (text.rfind(kFirstLine, 0) != 0 || text[kFirstLine.size()] != '\n') {
    throw InputError(file.string() +
                     ":1: no matches of this version; write them again with `groundloop match`");
  }
  const std::size_t end = text.rfind(kEnd);
  if (end == std::string::npos ||
      text.substr(end) != std::string(kEnd) +
                              std::to_string(checksum(std::string_view(text).substr(0, end))) +
                              "\n") {
    throw InputError(file.string() +
                     ": damaged or cut off; write it again with `groundloop match`");
  }
  std::vector<PairMatches> pairs;
  const std::string_view body = std::string_view(text).substr(0, end);
  for_each_row(file, body, 1, [&](const TableRow& row) {
    if (row.text(0) == "# pair") {
      row.expect_fields(5);
      pairs.push_back({row.text(1),
                       row.text(3),
                       row.integer<std::uint64_t>(2),
                       row.integer<std::uint64_t>(4),
                       {}});
      return;
    }
    row.expect_fields(kClosureFields + kInformationFields);
    if (row.text(0) == "reference_session") return;
    ClosureRecord closure = closure_from(row);
    closure.information = information_from(row);
    const auto pair = std::find_if(pairs.begin(), pairs.end(), [&](const PairMatches& p) {
      return p.reference == closure.reference_session && p.query == closure.query_session;
    });
    if (pair == pairs.end()) row.fail("a closure of sessions that no line names");
    pair->closures.push_back(std::move(closure));
  });
  return pairs;
}

}  // namespace groundloop
