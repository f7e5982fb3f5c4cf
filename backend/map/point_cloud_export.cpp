#include "backend/map/point_cloud_export.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop {
namespace {

static_assert(std::endian::native == std::endian::little, "the formats are little-endian");

template <typename T>
void append(std::vector<char>& bytes, T value) {
  std::array<char, sizeof value> raw;
  std::memcpy(raw.data(), &value, sizeof value);
  bytes.insert(bytes.end(), raw.begin(), raw.end());
}

// A text header of a fixed length, whatever the count: a comment takes up the slack.
std::string padded_header(const std::string& before_comment, const std::string& comment,
                          const std::string& after_comment) {
  constexpr std::size_t kLength = 384;
  std::string text = before_comment + comment;
  check(text.size() + after_comment.size() + 1 <= kLength, "header fits");
  text.append(kLength - text.size() - after_comment.size() - 1, ' ');
  return text + "\n" + after_comment;
}

std::string pcd_header(std::uint64_t count, const ExportFields& fields) {
  const std::string n = std::to_string(count);
  const auto line = [&](const char* name, const char* each, const char* intensity,
                        const char* session) {
    return std::string(name) + each + (fields.intensity ? intensity : "") +
           (fields.session ? session : "") + "\n";
  };
  return padded_header("", "# .PCD v0.7 - Point Cloud Data file format",
                       "VERSION 0.7\n" + line("FIELDS", " x y z", " intensity", " session") +
                           line("SIZE", " 4 4 4", " 4", " 2") + line("TYPE", " F F F", " F", " U") +
                           line("COUNT", " 1 1 1", " 1", " 1") + "WIDTH " + n +
                           "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA binary\n");
}

std::string ply_header(std::uint64_t count, const ExportFields& fields) {
  return padded_header("ply\nformat binary_little_endian 1.0\n", "comment groundloop, metres",
                       "element vertex " + std::to_string(count) +
                           "\nproperty float x\nproperty float y\nproperty float z\n" +
                           (fields.intensity ? "property float intensity\n" : "") +
                           (fields.session ? "property ushort session\n" : "") + "end_header\n");
}

// PCD and PLY: a text header and records of floats.
class FloatWriter : public PointCloudWriter {
 public:
  using Header = std::string (*)(std::uint64_t count, const ExportFields& fields);

  FloatWriter(const std::filesystem::path& file, Header header, const ExportFields& fields)
      : file_(file), header_(header), fields_(fields) {
    file_.write(header_(0, fields_));
  }

  void write(std::span<const ExportPoint> points) override {
    bytes_.clear();
    for (const ExportPoint& point : points) {
      for (int k = 0; k < 3; ++k) append(bytes_, static_cast<float>(point.position[k]));
      if (fields_.intensity) append(bytes_, point.intensity);
      if (fields_.session) append(bytes_, point.session);
    }
    file_.write(bytes_.data(), bytes_.size());
    count_ += points.size();
  }

  void finish() override {
    file_.write_at_start(header_(count_, fields_));
    file_.commit();
  }

 private:
  OutputFile file_;
  Header header_;
  ExportFields fields_;
  std::vector<char> bytes_;
};

// Intensities over the whole of 16 bits, as LAS asks for.
float las_intensity_scale(const ExportFields& fields) {
  if (!fields.intensity) return 0.0F;
  if (fields.largest_intensity <= 1.0F) return 65535.0F;
  return fields.largest_intensity <= 255.0F ? 257.0F : 1.0F;
}

// LAS, point data record format 0. The points begin where the longer header of version 1.4 would
// end, so that the version can be chosen once their number is known.
class LasWriter : public PointCloudWriter {
 public:
  LasWriter(const std::filesystem::path& file, const ExportFields& fields)
      : file_(file), name_(file.string()), intensity_scale_(las_intensity_scale(fields)) {
    const std::vector<char> blank(kHeader14, 0);
    file_.write(blank.data(), blank.size());
  }

  void write(std::span<const ExportPoint> points) override {
    bytes_.clear();
    for (const ExportPoint& point : points) {
      for (int k = 0; k < 3; ++k) {
        const double scaled = std::round(point.position[k] / kScale);
        if (!(std::abs(scaled) <= std::numeric_limits<std::int32_t>::max())) {
          throw InputError(name_ + ": a coordinate of " + to_text(point.position[k]) +
                           " m does not fit LAS at 1 mm (2147 km); check the poses");
        }
        append(bytes_, static_cast<std::int32_t>(scaled));
        min_[k] = std::min(min_[k], scaled * kScale);
        max_[k] = std::max(max_[k], scaled * kScale);
      }
      const float intensity = std::round(intensity_scale_ * point.intensity);
      append(bytes_, static_cast<std::uint16_t>(std::clamp(intensity, 0.0F, 65535.0F)));
      append(bytes_, std::uint8_t{1 | 8});  // return 1 of 1
      append(bytes_, std::uint8_t{0});      // never classified
      append(bytes_, std::int8_t{0});       // scan angle
      append(bytes_, std::uint8_t{0});      // user data
      append(bytes_, point.session);        // point source id
    }
    file_.write(bytes_.data(), bytes_.size());
    count_ += points.size();
  }

  void finish() override {
    const std::vector<char> header = las_header();
    file_.write_at_start({header.data(), header.size()});
    file_.commit();
  }

 private:
  static constexpr double kScale = 0.001;
  static constexpr std::size_t kHeader12 = 227;
  static constexpr std::size_t kHeader14 = 375;

  [[nodiscard]] std::vector<char> las_header() const {
    const bool large = count_ > std::numeric_limits<std::uint32_t>::max();
    std::vector<char> h;
    const auto text = [&h](const char* value, std::size_t length) {
      std::string padded(value);
      padded.resize(length, '\0');
      h.insert(h.end(), padded.begin(), padded.end());
    };
    text("LASF", 4);
    append(h, std::uint32_t{0});  // file source id, global encoding
    text("", 16);                 // project id
    append(h, std::uint8_t{1});
    append(h, static_cast<std::uint8_t>(large ? 4 : 2));
    text("EXTRACTION", 32);
    text("groundloop", 32);
    append(h, std::uint32_t{0});  // day and year of creation: the same bytes every run
    append(h, static_cast<std::uint16_t>(large ? kHeader14 : kHeader12));
    append(h, static_cast<std::uint32_t>(kHeader14));
    append(h, std::uint32_t{0});   // variable length records
    append(h, std::uint8_t{0});    // point data record format
    append(h, std::uint16_t{20});  // bytes a record
    const auto legacy = static_cast<std::uint32_t>(large ? 0 : count_);
    append(h, legacy);
    append(h, legacy);  // points of the first return, then of four more
    for (int i = 0; i < 4; ++i) append(h, std::uint32_t{0});
    for (int k = 0; k < 3; ++k) append(h, kScale);
    for (int k = 0; k < 3; ++k) append(h, 0.0);
    for (int k = 0; k < 3; ++k) {
      append(h, count_ > 0 ? max_[k] : 0.0);
      append(h, count_ > 0 ? min_[k] : 0.0);
    }
    check(h.size() == kHeader12, "the LAS 1.2 header has 227 bytes");
    if (large) {
      append(h, std::uint64_t{0});  // waveform data
      append(h, std::uint64_t{0});  // extended variable length records
      append(h, std::uint32_t{0});
      append(h, count_);
      append(h, count_);  // points of the first return, then of fourteen more
      for (int i = 0; i < 14; ++i) append(h, std::uint64_t{0});
      check(h.size() == kHeader14, "the LAS 1.4 header has 375 bytes");
    }
    return h;
  }

  OutputFile file_;
  std::string name_;
  float intensity_scale_;
  Eigen::Vector3d min_ = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d max_ = -min_;
  std::vector<char> bytes_;
};

}  // namespace

std::unique_ptr<PointCloudWriter> open_point_cloud_writer(const std::filesystem::path& file,
                                                          const ExportFields& fields) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".pcd") return std::make_unique<FloatWriter>(file, pcd_header, fields);
  if (extension == ".ply") return std::make_unique<FloatWriter>(file, ply_header, fields);
  if (extension == ".las") return std::make_unique<LasWriter>(file, fields);
  throw InputError(file.string() + ": unknown ending '" + extension +
                   "'; point clouds are written as .pcd, .ply or .las");
}

}  // namespace groundloop
