#include "backend/session/scan_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <span>
#include <string_view>

#include "backend/registration/voxel_pyramid.hpp"
#include "frontend/core/binary_io.hpp"
#include "frontend/core/checksum.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop {
namespace fs = std::filesystem;

namespace {

static_assert(std::endian::native == std::endian::little, "files are little-endian");

constexpr float kFinestStep = 1.0F / 256.0F;  // m; rounding errs by 1.1 mm, a LiDAR by ten times it
constexpr float kCoarsestStep = 4.0F;         // holds kFurthestPoint
constexpr float kMostSteps = 32767.0F;
constexpr float kMostIntensity = 65535.0F;

struct FileHead {
  std::uint64_t magic = kScanFileMagic, sum = 0;
  std::uint32_t scans = 0;
  float largest_intensity = -1.0F;
};
constexpr std::size_t kSummedFrom = 16;  // bytes; what lies behind magic and sum

struct ScanHead {
  std::uint32_t scan = 0, points = 0;
  float step = kFinestStep, intensity_step = 0.0F;
};
static_assert(sizeof(FileHead) == 24 && sizeof(ScanHead) == 16, "heads are written as they lie");

constexpr std::size_t kPointBytes = 3 * sizeof(std::int16_t);
constexpr std::size_t kIntensityBytes = sizeof(std::uint16_t);

// Powers of two from the finest: dividing by them is exact.
float step_for(float reach) {
  float step = kFinestStep;
  while (step * kMostSteps < reach) step *= 2.0F;
  return step;
}

// Counts up to 511 are kept exactly and in steps fine enough for what is no count; shares of one
// finer still.
float intensity_step_for(float largest) {
  if (largest <= 1.0F) return 1.0F / 65536.0F;
  return largest < 512.0F ? 1.0F / 128.0F : 1.0F;
}

float sound_intensity(float value) {
  return value > 0.0F ? std::min(value, kMostIntensity) : 0.0F;  // NaN is not above 0
}

template <typename T>
void append(std::vector<char>& bytes, std::span<const T> values) {
  if (values.empty()) return;
  const std::size_t at = bytes.size();
  bytes.resize(at + values.size_bytes());
  std::memcpy(bytes.data() + at, values.data(), values.size_bytes());
}

// Reads values from bytes whose length was asked for before.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  [[nodiscard]] std::size_t left() const { return bytes_.size(); }
  template <typename T>
  T get() {
    T value;
    get_all(&value, 1);
    return value;
  }
  template <typename T>
  void get_all(T* values, std::size_t count) {
    if (count == 0) return;
    std::memcpy(static_cast<void*>(values), bytes_.data(), count * sizeof(T));
    bytes_ = bytes_.subspan(count * sizeof(T));
  }

 private:
  std::span<const std::byte> bytes_;
};

[[noreturn]] void fail(const fs::path& file, const std::string& what) {
  throw InputError(file.string() + ": " + what + "; run the session again");
}

bool is_step(float step) {
  int exponent = 0;
  return step >= kFinestStep && step <= kCoarsestStep && std::frexp(step, &exponent) == 0.5F;
}

bool is_intensity_step(float step) {
  return step == 0.0F || step == 1.0F || step == 1.0F / 128.0F || step == 1.0F / 65536.0F;
}

// Everything about a scan's head that what follows relies on.
void check_head(const fs::path& file, const ScanHead& head, const std::vector<KeptScan>& before,
                std::size_t left) {
  const std::string place = "scan " + std::to_string(head.scan);
  if (!before.empty() && head.scan <= before.back().scan)
    fail(file, place + " does not come after scan " + std::to_string(before.back().scan));
  if (!is_step(head.step) || !is_intensity_step(head.intensity_step))
    fail(file, place + " has steps that are not written");
  const std::size_t record = kPointBytes + (head.intensity_step > 0.0F ? kIntensityBytes : 0);
  if (head.points > left / record) fail(file, place + " is cut off");
}

KeptScan read_scan(Reader& reader, const ScanHead& head) {
  KeptScan result;
  result.scan = head.scan;
  result.points.resize(head.points);
  std::vector<std::array<std::int16_t, 3>> steps(head.points);
  reader.get_all(steps.data(), steps.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    result.points[i] = head.step * Eigen::Vector3f(static_cast<float>(steps[i][0]),
                                                   static_cast<float>(steps[i][1]),
                                                   static_cast<float>(steps[i][2]));
  }
  if (head.intensity_step == 0.0F) return result;
  std::vector<std::uint16_t> intensity(head.points);
  reader.get_all(intensity.data(), intensity.size());
  result.intensity.reserve(intensity.size());
  for (const std::uint16_t value : intensity)
    result.intensity.push_back(head.intensity_step * static_cast<float>(value));
  return result;
}

}  // namespace

void ScanFileBuilder::add(const KeptScan& scan) {
  check(scan.intensity.empty() || scan.intensity.size() == scan.points.size(),
        "intensities are one a point");
  float reach = 0.0F, largest = 0.0F;
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (!has_voxel(scan.points[i])) continue;
    ++count;
    reach = std::max(reach, scan.points[i].cwiseAbs().maxCoeff());
    if (!scan.intensity.empty()) largest = std::max(largest, sound_intensity(scan.intensity[i]));
  }
  ScanHead head{scan.scan, count, step_for(reach), 0.0F};
  if (!scan.intensity.empty()) {
    head.intensity_step = intensity_step_for(largest);
    largest_intensity_ = std::max(largest_intensity_, largest);
  }
  append<ScanHead>(body_, std::span(&head, 1));
  const float inverse = 1.0F / head.step;
  std::vector<std::int16_t> steps;
  steps.reserve(3 * std::size_t{count});
  std::vector<std::uint16_t> intensities;
  intensities.reserve(scan.intensity.size());
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (!has_voxel(scan.points[i])) continue;
    for (int k = 0; k < 3; ++k)
      steps.push_back(static_cast<std::int16_t>(std::lround(scan.points[i][k] * inverse)));
    if (scan.intensity.empty()) continue;
    const float value = std::round(sound_intensity(scan.intensity[i]) / head.intensity_step);
    intensities.push_back(static_cast<std::uint16_t>(std::min(value, kMostIntensity)));
  }
  append<std::int16_t>(body_, steps);
  append<std::uint16_t>(body_, intensities);
  ++scans_;
}

void ScanFileBuilder::write(const fs::path& file) {
  FileHead head;
  head.scans = scans_;
  head.largest_intensity = largest_intensity_;
  const std::span<const std::byte> raw = std::as_bytes(std::span(&head, 1));
  head.sum = Checksum().add(raw.subspan(kSummedFrom)).add(std::as_bytes(std::span(body_))).value();
  OutputFile out(file);
  out.write(&head, sizeof head);
  out.write(body_.data(), body_.size());
  out.commit();
  *this = {};
}

void ScanFileBuilder::save(std::ostream& out) const {
  put(out, scans_);
  put(out, largest_intensity_);
  put_all(out, body_);
}

void ScanFileBuilder::load(std::istream& in) {
  get(in, scans_);
  get(in, largest_intensity_);
  get_all(in, body_);
  // What is read back from the file in the end is checked there.
  if (scans_ > body_.size() / sizeof(ScanHead)) in.setstate(std::ios::failbit);
}

std::vector<KeptScan> read_scan_file(const fs::path& file) {
  const std::vector<std::byte> bytes = read_file(file);
  Reader reader(bytes);
  FileHead head;
  head.magic = 0;
  if (bytes.size() >= sizeof head) head = reader.get<FileHead>();
  if (head.magic != kScanFileMagic)
    fail(file, "holds no scans of groundloop, or of another version");
  if (head.sum != checksum(std::span(bytes).subspan(kSummedFrom)))
    fail(file, "differs from its checksum, so it is damaged");
  std::vector<KeptScan> scans;
  for (std::uint32_t i = 0; i < head.scans; ++i) {
    if (reader.left() < sizeof(ScanHead)) fail(file, "is cut off");
    const auto next = reader.get<ScanHead>();
    check_head(file, next, scans, reader.left());
    scans.push_back(read_scan(reader, next));
  }
  if (reader.left() > 0) fail(file, "holds more than its scans");
  return scans;
}

float largest_intensity_of(const fs::path& file) {
  std::uintmax_t size = 0;
  std::ifstream in = open_for_reading(file, size);
  FileHead head;
  head.magic = 0;
  get(in, head);
  const bool sound = in && head.magic == kScanFileMagic &&
                     head.largest_intensity <= kMostIntensity;  // false for NaN
  if (!sound) fail(file, "holds no scans of groundloop, or of another version");
  return head.largest_intensity;
}

}  // namespace groundloop
