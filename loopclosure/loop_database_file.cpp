// The loop database on disk: a magic word, a version, the descriptions, and an FNV-1a checksum of
// all that. Numbers are little-endian, as on every machine groundloop builds for.

#include <bit>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "loopclosure/loop_database.hpp"

namespace groundloop {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr char kMagic[8] = {'G', 'L', 'O', 'O', 'P', 'D', 'B', '\0'};
constexpr std::uint32_t kVersion = 1;

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
  return d;
}

}  // namespace

void LoopDatabase::save(const std::filesystem::path& file) const {
  Writer out;
  out.values(kMagic, sizeof(kMagic));
  out.value(kVersion);
  out.value(static_cast<std::uint32_t>(descriptions_.size()));
  for (const MapDescription& d : descriptions_) write(out, d);
  out.value(fnv1a(out.bytes()));
  AtomicFile target(file);
  target.write(out.bytes().data(), out.bytes().size());
  target.commit();
}

LoopDatabase LoopDatabase::load(const std::filesystem::path& file,
                                const LoopClosureOptions& options) {
  const std::vector<std::byte> bytes = read_file(file);
  const std::string name = file.string();
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
  std::uint64_t checksum = 0;
  std::memcpy(&checksum, bytes.data() + body.size(), sizeof(checksum));
  if (checksum != fnv1a(body)) {
    throw InputError(name +
                     ": the checksum differs, so the file is damaged; write it again with "
                     "`groundloop run`");
  }
  const auto count = in.value<std::uint32_t>();
  LoopDatabase database(options);
  for (std::uint32_t i = 0; i < count; ++i) database.insert(read(in));
  if (in.left() != 0) in.fail("bytes follow the last description");
  return database;
}

}  // namespace groundloop
