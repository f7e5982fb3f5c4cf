#include "frontend/recordings/bin_layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "frontend/core/error.hpp"
#include "frontend/recordings/source_tools.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kFewest = 3, kMost = 8;      // values of a record
constexpr std::size_t kUsual = 4, kMostUsual = 6;  // those that lengths alone may choose
constexpr std::size_t kFilesRead = 8;
constexpr std::size_t kBytesRead = 1U << 18U;  // of each
constexpr std::size_t kEnough = 1200;          // values that tell
constexpr double kLargestRing = 255.0;

struct Stream {
  std::vector<float> values;
};

// The beginnings of a few files, from which records can be cut wherever they begin.
std::vector<Stream> read_streams(const std::vector<fs::path>& files) {
  std::vector<Stream> streams;
  for (const std::size_t index : spread_indices(files.size(), kFilesRead)) {
    std::ifstream in(files[index], std::ios::binary);
    std::vector<char> bytes(kBytesRead);
    in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    Stream stream;
    stream.values.resize(static_cast<std::size_t>(in.gcount()) / sizeof(float));
    std::memcpy(stream.values.data(), bytes.data(), stream.values.size() * sizeof(float));
    streams.push_back(std::move(stream));
  }
  return streams;
}

// The mean of sqrt|v[i] - v[i + lag]|; values that are none count as far away.
double unlikeness(const std::vector<Stream>& streams, std::size_t lag) {
  constexpr double kFar = 1e3;
  double sum = 0.0;
  std::size_t count = 0;
  for (const Stream& stream : streams) {
    for (std::size_t i = 0; i + lag < stream.values.size(); ++i) {
      const double d = std::abs(static_cast<double>(stream.values[i]) -
                                static_cast<double>(stream.values[i + lag]));
      sum += std::isfinite(d) ? std::sqrt(std::min(d, kFar)) : std::sqrt(kFar);
      ++count;
    }
  }
  return count == 0 ? 0.0 : sum / static_cast<double>(count);
}

// Files whose length is a multiple of so many values.
std::size_t fitting_files(const std::vector<fs::path>& files, std::size_t values) {
  return static_cast<std::size_t>(std::count_if(files.begin(), files.end(), [&](const auto& file) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(file, error);
    return !error && size % (values * sizeof(float)) == 0;
  }));
}

// 4, 5 or 6 values, whichever divides the lengths of most files. A file that is cut off must not
// make all the others look strange.
std::size_t by_lengths(const std::vector<fs::path>& files) {
  std::size_t best = kUsual;
  for (std::size_t k = kMostUsual; k > kUsual; --k) {
    if (fitting_files(files, k) > fitting_files(files, best)) best = k;
  }
  return best;
}

bool is_ring(const std::vector<Stream>& streams, std::size_t record, std::size_t field) {
  float largest = 0.0F;
  for (const Stream& stream : streams) {
    for (std::size_t i = field; i < stream.values.size(); i += record) {
      const float value = stream.values[i];
      if (!(value >= 0.0F && value <= kLargestRing && value == std::floor(value))) return false;
      largest = std::max(largest, value);
    }
  }
  return largest > 0.0F;
}

std::vector<std::string> names_of(const std::vector<Stream>& streams, std::size_t record) {
  std::vector<std::string> names = {"x", "y", "z"};
  if (record > 3) names.emplace_back("intensity");
  const bool ring = record > 4 && is_ring(streams, record, 4);
  if (record > 4) names.emplace_back(ring ? "ring" : "value5");
  if (record > 5) names.emplace_back(ring ? "t" : "value6");
  while (names.size() < record) names.push_back("value" + std::to_string(names.size() + 1));
  return names;
}

std::vector<std::string> asked_fields(const std::string& asked) {
  std::vector<std::string> fields;
  std::istringstream text(asked);
  std::string name;
  while (std::getline(text, name, ',')) fields.push_back(name);
  for (const char* needed : {"x", "y", "z"}) {
    if (std::count(fields.begin(), fields.end(), needed) != 1) {
      throw InputError("--fields " + asked.substr(0, 200) + ": has no or several '" + needed +
                       "'; name each value of a record, e.g. x,y,z,intensity,ring,t");
    }
  }
  return fields;
}

}  // namespace

PointLayout BinLayout::layout() const {
  PointLayout layout;
  for (const std::string& field : fields) layout.append(field, FieldType::float32);
  layout.set_records(0);
  return layout;
}

BinLayout choose_bin_layout(const std::vector<fs::path>& files, const std::string& asked) {
  if (!asked.empty()) return {asked_fields(asked), "Fields of a record are those of --fields."};
  const std::vector<Stream> streams = read_streams(files);
  std::size_t values = 0;
  for (const Stream& stream : streams) values += stream.values.size();
  const std::size_t usual = by_lengths(files);
  if (values < kEnough) return {names_of(streams, usual), {}};

  // Lengths decide against a number of values where they fit it less often than another.
  std::array<std::size_t, kMost + 1> fitting{};
  std::size_t most = 0;
  for (std::size_t k = kFewest; k <= kMost; ++k)
    most = std::max(most, fitting[k] = fitting_files(files, k));
  std::size_t best = 0, others = 0;
  double least = 0.0;
  for (std::size_t k = kFewest; k <= kMost; ++k) {
    if (2 * fitting[k] <= most) continue;
    ++others;
    const double here = unlikeness(streams, k);
    // A multiple of the right number is hardly worse than it.
    if (best == 0 || here < 0.97 * least) {
      best = k;
      least = here;
    }
  }
  if (best == 0) return {names_of(streams, usual), {}};
  BinLayout chosen{names_of(streams, best), {}};
  if (others > 1 || best != kUsual) {
    chosen.evidence =
        "Records are taken to be of " + std::to_string(best) +
        " float32 values, in which each is most like its neighbours" +
        (best > 4 && chosen.fields[4] == "ring" ? "; the fifth is a ring (whole)" : "") +
        "; --fields overrules.";
  }
  return chosen;
}

}  // namespace groundloop::recordings
