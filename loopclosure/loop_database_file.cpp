// The loop database on disk: a magic word, a version, the descriptions, and a checksum of
// all that. Numbers are little-endian, as on every machine groundloop builds for.

#include <bit>
#include <cmath>
#include <cstring>
#include <set>
#include <span>
#include <string>
#include <type_traits>

#include "frontend/core/checksum.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "loopclosure/loop_database.hpp"

namespace groundloop {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr char kMagic[8] = {'G', 'L', 'O', 'O', 'P', 'D', 'B', '\0'};
constexpr std::uint32_t kVersion = 2;

class Writer {
 public:
  template <typename T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* bytes = reinterpret_cast<const std::byte*>(&v);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof(T));
  }
  template <typename T>
  void values(const T* data, std::size_t count) {
    const auto* bytes = reinterpret_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), bytes, bytes + count * sizeof(T));
  }
  [[nodiscard]] const std::vector<std::byte>& bytes() const { return bytes_; }
  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

class Reader {
 public:
  Reader(std::span<const std::byte> bytes, std::string file)
      : bytes_(bytes), file_(std::move(file)) {}
  template <typename T>
  T value() {
    T v;
    values(&v, 1);
    return v;
  }
  template <typename T>
  void values(T* data, std::size_t count) {
    if (count > (bytes_.size() - at_) / sizeof(T)) fail("ends within a description");
    if (count > 0) std::memcpy(static_cast<void*>(data), bytes_.data() + at_, count * sizeof(T));
    at_ += count * sizeof(T);
  }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(file_ + ": byte " + std::to_string(at_) + ": " + what +
                     "; write it again with `groundloop run`");
  }

 private:
  std::span<const std::byte> bytes_;
  std::string file_;
  std::size_t at_ = 0;
};

void write(Writer& out, const MapDescription& d) {
  out.value(static_cast<std::int32_t>(d.key.session));
  out.value(static_cast<std::int32_t>(d.key.map));
  out.values(d.T_ground_map.rotation.coeffs().data(), 4);
  out.values(d.T_ground_map.translation.data(), 3);
  out.value(d.ground_quality);
  out.value(static_cast<std::uint32_t>(d.keypoints.size()));
  for (std::size_t i = 0; i < d.keypoints.size(); ++i) {
    out.values(d.keypoints[i].data(), 2);
    out.value(d.orientations.empty() ? 0.0F : d.orientations[i]);
    out.values(d.descriptors[i].data(), d.descriptors[i].size());
  }
}

// A checksum tells damage, not what somebody else's program wrote: no number that is none, or that
// no map could have, goes on from here. (maxCoeff would lose a NaN.)
void check_plausible(const MapDescription& d, const Reader& in) {
  constexpr float kFar = 1e5F;   // m
  constexpr float kTurn = 7.0F;  // rad, a little more than a whole one
  if (d.key.session < 0 || d.key.map < 0) in.fail("a map or session has a negative number");
  if (!(d.T_ground_map.translation.array().abs() < static_cast<double>(kFar)).all() ||
      !std::isfinite(d.ground_quality) || !(std::abs(d.T_ground_map.rotation.norm() - 1.0) < 1e-6))
    in.fail("the ground alignment is no pose");
  for (const Eigen::Vector2f& keypoint : d.keypoints) {
    if (!(keypoint.array().abs() < kFar).all()) in.fail("a keypoint lies nowhere near the map");
  }
  for (const float orientation : d.orientations) {
    if (!(std::abs(orientation) < kTurn)) in.fail("an orientation is no angle");
  }
}

MapDescription read(Reader& in) {
  MapDescription d;
  d.key.session = in.value<std::int32_t>();
  d.key.map = in.value<std::int32_t>();
  // Set coefficient by coefficient: a normalisation would change the last bits.
  in.values(d.T_ground_map.rotation.coeffs().data(), 4);
  in.values(d.T_ground_map.translation.data(), 3);
  d.ground_quality = in.value<double>();
  const auto count = in.value<std::uint32_t>();
  constexpr std::size_t kFeatureBytes = 3 * sizeof(float) + sizeof(Descriptor);
  if (count > in.left() / kFeatureBytes) in.fail("more features than the file can hold");
  d.keypoints.resize(count);
  d.orientations.resize(count);
  d.descriptors.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    in.values(d.keypoints[i].data(), 2);
    in.values(&d.orientations[i], 1);
    in.values(d.descriptors[i].data(), d.descriptors[i].size());
  }
  check_plausible(d, in);
  return d;
}

}  // namespace

std::vector<std::byte> LoopDatabase::bytes() const {
  Writer out;
  out.values(kMagic, sizeof(kMagic));
  out.value(kVersion);
  out.value(static_cast<std::uint32_t>(descriptions_.size()));
  for (const MapDescription& d : descriptions_) write(out, d);
  out.value(checksum(std::span<const std::byte>(out.bytes())));
  return out.take();
}

void LoopDatabase::save(const std::filesystem::path& file) const {
  const std::vector<std::byte> all = bytes();
  OutputFile target(file);
  target.write(all.data(), all.size());
  target.commit();
}

LoopDatabase LoopDatabase::load(const std::filesystem::path& file,
                                const LoopClosureOptions& options) {
  return from_bytes(read_file(file), file.string(), options);
}

LoopDatabase LoopDatabase::from_bytes(std::span<const std::byte> bytes, const std::string& name,
                                      const LoopClosureOptions& options) {
  constexpr std::size_t kHeader = sizeof(kMagic) + 2 * sizeof(std::uint32_t);
  if (bytes.size() < kHeader + sizeof(std::uint64_t) ||
      std::memcmp(bytes.data(), kMagic, sizeof(kMagic)) != 0) {
    throw InputError(name + ": no loop database; expected loop_database.bin of a session");
  }
  const std::span<const std::byte> body(bytes.data(), bytes.size() - sizeof(std::uint64_t));
  Reader in(body.subspan(sizeof(kMagic)), name);
  if (const auto version = in.value<std::uint32_t>(); version != kVersion) {
    throw InputError(name + ": version " + std::to_string(version) + " of the loop database, not " +
                     std::to_string(kVersion) + "; write it again with `groundloop run`");
  }
  std::uint64_t expected = 0;
  std::memcpy(&expected, bytes.data() + body.size(), sizeof(expected));
  if (expected != checksum(body)) {
    throw InputError(name +
                     ": the checksum differs, so the file is damaged; write it again with "
                     "`groundloop run`");
  }
  const auto count = in.value<std::uint32_t>();
  LoopDatabase database(options);
  std::set<MapKey> keys;
  for (std::uint32_t i = 0; i < count; ++i) {
    MapDescription description = read(in);
    if (!keys.insert(description.key).second) in.fail("a map occurs twice");
    database.insert(std::move(description));
  }
  if (in.left() != 0) in.fail("bytes follow the last description");
  return database;
}

}  // namespace groundloop
