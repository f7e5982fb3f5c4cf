#include "backend/mapping/checkpoint.hpp"

#include <cstring>
#include <filesystem>
#include <sstream>

#include "frontend/core/binary_io.hpp"
#include "frontend/core/files.hpp"

namespace groundloop {
namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMagic = 0x33304b4345484347ULL;  // "GCHECK03"
constexpr const char* kFile = "checkpoint.bin";
constexpr const char* kDatabase = "checkpoint_database.bin";

// A closure as it goes into the file; the session's name is the folder's.
struct StoredClosure {
  int reference_map, query_map, source, matches, inliers, status, has_overlap, has_rmse;
  double overlap, rmse, weight;
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
  s.overlap = c.overlap.value_or(0.0);
  s.rmse = c.rmse.value_or(0.0);
  s.weight = c.weight;
  s.T_query_reference = c.T_query_reference;
  s.initial_T_query_reference = c.initial_T_query_reference;
  s.information = c.information;
  return s;
}

ClosureRecord restore(const StoredClosure& s, const std::string& session) {
  ClosureRecord c;
  c.reference_session = c.query_session = session;
  c.reference_map = s.reference_map;
  c.query_map = s.query_map;
  c.source = static_cast<ClosureSource>(s.source);
  c.matches = s.matches;
  c.inliers = s.inliers;
  c.status = static_cast<ClosureStatus>(s.status);
  if (s.has_overlap != 0) c.overlap = s.overlap;
  if (s.has_rmse != 0) c.rmse = s.rmse;
  c.weight = s.weight;
  c.T_query_reference = s.T_query_reference;
  c.initial_T_query_reference = s.initial_T_query_reference;
  c.information = s.information;
  return c;
}

}  // namespace

bool Checkpoint::exists() const { return fs::exists(folder_.file(kFile)); }

void Checkpoint::save(const Odometry& odometry, const LocalMapBuilder& builder,
                      const ClosureFinder& finder, const Trajectory& trajectory) const {
  std::ostringstream body;
  odometry.save(body);
  builder.save(body);
  put_all(body, trajectory);
  put_all(body, finder.maps());
  std::vector<StoredClosure> closures;
  for (const ClosureRecord& c : finder.closures()) closures.push_back(store(c));
  put_all(body, closures);
  const std::string bytes = body.str();
  finder.database().save(folder_.file(kDatabase));
  AtomicFile out(folder_.file(kFile));
  put(out.stream(), kMagic);
  put(out.stream(), fnv1a(std::as_bytes(std::span(bytes.data(), bytes.size()))));
  out.write(bytes);
  out.commit();
}

void Checkpoint::load(Odometry& odometry, LocalMapBuilder& builder, ClosureFinder& finder,
                      Trajectory& trajectory, const LoopClosureOptions& options) const {
  const fs::path file = folder_.file(kFile);
  if (!exists())
    throw InputError(file.string() +
                     ": there is no interrupted run to resume; run without --resume");
  const std::string text = read_text(file);
  std::istringstream in(text);
  std::uint64_t magic = 0, checksum = 0;
  get(in, magic);
  get(in, checksum);
  constexpr std::size_t kHeader = 2 * sizeof(std::uint64_t);
  if (!in || magic != kMagic ||
      checksum != fnv1a(std::as_bytes(std::span(text.data() + kHeader, text.size() - kHeader)))) {
    throw InputError(
        file.string() +
        ": the checkpoint is damaged or of another version; run again without --resume");
  }
  odometry.load(in);
  builder.load(in);
  get_all(in, trajectory);
  std::vector<LocalMapRecord> maps;
  get_all(in, maps);
  std::vector<StoredClosure> stored;
  get_all(in, stored);
  std::vector<ClosureRecord> closures;
  closures.reserve(stored.size());
  for (const StoredClosure& s : stored) closures.push_back(restore(s, SessionFolder::kOwnName));
  finder.restore(LoopDatabase::load(folder_.file(kDatabase), options), std::move(maps),
                 std::move(closures));
}

void Checkpoint::remove() const {
  std::error_code error;
  fs::remove(folder_.file(kFile), error);
  fs::remove(folder_.file(kDatabase), error);
}

}  // namespace groundloop
