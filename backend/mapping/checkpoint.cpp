#include "backend/mapping/checkpoint.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "frontend/core/binary_io.hpp"
#include "frontend/core/checksum.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop {
namespace fs = std::filesystem;

namespace {

// A closure as it goes into the file; a session of one recording names none.
struct StoredClosure {
  int reference_map, query_map, source, matches, inliers, status, has_overlap, has_rmse,
      has_agreement;
  double overlap, rmse, agreement, weight;
  Pose T_query_reference, initial_T_query_reference;
  Matrix6d information;
};

StoredClosure store(const ClosureRecord& c) {
  StoredClosure s;
  // Padding is written too: zeroed, so that equal states give equal bytes.
  std::memset(static_cast<void*>(&s), 0, sizeof s);
  s.reference_map = c.reference_map;
  s.query_map = c.query_map;
  s.source = static_cast<int>(c.source);
  s.matches = c.matches;
  s.inliers = c.inliers;
  s.status = static_cast<int>(c.status);
  s.has_overlap = c.overlap.has_value() ? 1 : 0;
  s.has_rmse = c.rmse.has_value() ? 1 : 0;
  s.has_agreement = c.agreement.has_value() ? 1 : 0;
  s.overlap = c.overlap.value_or(0.0);
  s.rmse = c.rmse.value_or(0.0);
  s.agreement = c.agreement.value_or(0.0);
  s.weight = c.weight;
  s.T_query_reference = c.T_query_reference;
  s.initial_T_query_reference = c.initial_T_query_reference;
  s.information = c.information;
  return s;
}

ClosureRecord restore(const StoredClosure& s) {
  ClosureRecord c;
  c.reference_map = s.reference_map;
  c.query_map = s.query_map;
  c.source = static_cast<ClosureSource>(s.source);
  c.matches = s.matches;
  c.inliers = s.inliers;
  c.status = static_cast<ClosureStatus>(s.status);
  if (s.has_overlap != 0) c.overlap = s.overlap;
  if (s.has_rmse != 0) c.rmse = s.rmse;
  if (s.has_agreement != 0) c.agreement = s.agreement;
  c.weight = s.weight;
  c.T_query_reference = s.T_query_reference;
  c.initial_T_query_reference = s.initial_T_query_reference;
  c.information = s.information;
  return c;
}

std::uint64_t identity_sum(const SessionIdentity& identity) {
  Checksum sum;
  for (const std::string* text :
       {&identity.command, &identity.version, &identity.input, &identity.configuration})
    sum.add(*text).add_value('\0');
  return sum.value();
}

// A quality for each scan, in a state that there is.
bool consistent(const RunState& state) {
  return state.quality.size() == state.trajectory.size() &&
         std::all_of(state.quality.begin(), state.quality.end(), [](const ScanQuality& q) {
           return q.state >= OdometryState::good && q.state <= OdometryState::predicted &&
                  q.weakest >= 0 && q.weakest < 6;
         });
}

}  // namespace

Checkpoint::Checkpoint(const SessionFolder& folder, const SessionIdentity& identity)
    : file_(folder.file("checkpoint.bin")), identity_(identity_sum(identity)) {}

bool Checkpoint::exists() const {
  std::error_code error;
  return fs::exists(file_, error);
}

void Checkpoint::save(const RunState& state) const {
  std::ostringstream body;
  put(body, identity_);
  put(body, state.times);
  put(body, state.scans_finished);
  put(body, state.unusable_scans);
  state.odometry.save(body);
  state.builder.save(body);
  state.keeper.save(body);
  put_all(body, state.trajectory);
  put_all(body, state.quality);
  put_all(body, state.finder.maps());
  std::vector<StoredClosure> closures;
  for (const ClosureRecord& c : state.finder.closures()) closures.push_back(store(c));
  put_all(body, closures);
  put_all(body, state.finder.database().bytes());
  const std::string_view bytes = body.view();
  const std::array<std::uint64_t, 2> head{kCheckpointMagic, checksum(bytes)};
  OutputFile out(file_);
  out.write(head.data(), sizeof head);
  out.write(bytes);
  out.commit();
}

void Checkpoint::load(RunState& state, const LoopClosureOptions& options) const {
  const std::string text = read_text(file_);
  std::istringstream in(text);
  std::array<std::uint64_t, 2> head{};
  get(in, head);
  if (!in || head[0] != kCheckpointMagic ||
      head[1] != checksum(std::string_view(text).substr(sizeof head))) {
    throw InputError(file_.string() +
                     ": the checkpoint is damaged or of another version; run again with "
                     "--overwrite");
  }
  std::uint64_t identity = 0;
  get(in, identity);
  if (identity != identity_) {
    throw InputError(file_.string() +
                     ": the checkpoint belongs to another recording or configuration; run again "
                     "with --overwrite");
  }
  get(in, state.times);
  get(in, state.scans_finished);
  get(in, state.unusable_scans);
  state.odometry.load(in);
  state.builder.load(in);
  state.keeper.load(in);
  // A right checksum does not say that the numbers fit each other.
  if (!in)
    throw InputError(file_.string() + ": the checkpoint is damaged; run again with --overwrite");
  get_all(in, state.trajectory);
  get_all(in, state.quality);
  if (!consistent(state))
    throw InputError(file_.string() + ": the checkpoint is damaged; run again with --overwrite");
  std::vector<LocalMapRecord> maps;
  get_all(in, maps);
  std::vector<StoredClosure> stored;
  get_all(in, stored);
  std::vector<ClosureRecord> closures;
  closures.reserve(stored.size());
  for (const StoredClosure& s : stored) closures.push_back(restore(s));
  std::vector<std::byte> database;
  get_all(in, database);
  state.finder.restore(LoopDatabase::from_bytes(database, file_.string(), options), std::move(maps),
                       std::move(closures));
}

}  // namespace groundloop
