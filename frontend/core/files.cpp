#include "frontend/core/files.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <system_error>

#include "frontend/core/error.hpp"
#include "frontend/core/scan.hpp"
#include "frontend/core/unreadable_file.hpp"

namespace groundloop {
namespace fs = std::filesystem;

namespace {

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

}  // namespace

std::ifstream open_for_reading(const fs::path& file, std::uintmax_t& size) {
  std::error_code error;
  if (!fs::exists(file, error))
    throw UnreadableFile(file.string() + ": no such file; check the path");
  if (fs::is_directory(file, error))
    throw InputError(file.string() + ": is a folder, expected a file");
  size = fs::file_size(file, error);
  std::ifstream in(file, std::ios::binary);
  if (error || !in) throw UnreadableFile(file.string() + ": cannot be read; check its permissions");
  return in;
}

std::vector<std::byte> read_file(const fs::path& file) {
  std::uintmax_t size = 0;
  std::ifstream in = open_for_reading(file, size);
  std::vector<std::byte> bytes(size);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(in.gcount()) != size) {
    throw UnreadableFile(file.string() + ": ended after " + std::to_string(in.gcount()) + " of " +
                         std::to_string(size) + " bytes; is it still being written?");
  }
  return bytes;
}

std::string read_text(const fs::path& file) {
  const std::vector<std::byte> bytes = read_file(file);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool natural_less(std::string_view a, std::string_view b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      std::size_t i_end = i, j_end = j;
      while (i_end < a.size() && is_digit(a[i_end])) ++i_end;
      while (j_end < b.size() && is_digit(b[j_end])) ++j_end;
      while (i + 1 < i_end && a[i] == '0') ++i;
      while (j + 1 < j_end && b[j] == '0') ++j;
      if (i_end - i != j_end - j) return i_end - i < j_end - j;
      const int order = a.substr(i, i_end - i).compare(b.substr(j, j_end - j));
      if (order != 0) return order < 0;
      i = i_end;
      j = j_end;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  if ((i < a.size()) != (j < b.size())) return j < b.size();
  return a < b;  // equal but for leading zeros: any fixed order
}

std::vector<fs::path> list_files(const fs::path& folder, std::string_view extension) {
  std::error_code error;
  fs::directory_iterator it(folder, error);
  if (error) throw InputError(folder.string() + ": cannot be read as a folder: " + error.message());
  std::vector<fs::path> files;
  const auto lower = [](std::string s) {
    std::transform(s.begin(), s.end(), s.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return s;
  };
  for (const fs::directory_entry& entry : it) {
    if (!entry.is_regular_file(error)) continue;
    if (extension.empty() || lower(entry.path().extension().string()) == extension)
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().native(), b.filename().native());
  });
  return files;
}

std::string to_text(double value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

std::string seconds_text(std::int64_t nanoseconds) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const bool negative = nanoseconds < 0;
  // Magnitude without overflow for the most negative value.
  const std::uint64_t magnitude = negative ? 0 - static_cast<std::uint64_t>(nanoseconds)
                                           : static_cast<std::uint64_t>(nanoseconds);
  std::string fraction = std::to_string(magnitude % kSecond);
  fraction.insert(0, 9 - fraction.size(), '0');
  return (negative ? "-" : "") + std::to_string(magnitude / kSecond) + "." + fraction;
}

bool parse_double(std::string_view text, double& value) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc() && result.ptr == text.data() + text.size() &&
         std::isfinite(value);
}

bool parse_seconds(std::string_view text, std::int64_t& nanoseconds) {
  const std::size_t dot = text.find('.');
  const bool plain =
      !text.empty() &&
      text.find_first_not_of("0123456789.", text.front() == '-' ? 1 : 0) == std::string_view::npos;
  if (plain && text.find_first_of("0123456789") != std::string_view::npos) {
    const bool negative = text.front() == '-';
    const std::string_view whole = text.substr(
        negative ? 1 : 0, dot == std::string_view::npos ? text.size() : dot - (negative ? 1 : 0));
    std::int64_t seconds = 0;
    const auto result = std::from_chars(whole.data(), whole.data() + whole.size(), seconds);
    const bool fits =
        whole.empty() || (result.ec == std::errc() && result.ptr == whole.data() + whole.size());
    if (fits && seconds < kFarthestStamp / 1'000'000'000) {
      std::string digits(dot == std::string_view::npos ? "" : text.substr(dot + 1));
      if (digits.find('.') != std::string::npos) return false;
      const bool round_up = digits.size() > 9 && digits[9] >= '5';
      digits.resize(9, '0');
      std::int64_t fraction = 0;
      std::from_chars(digits.data(), digits.data() + digits.size(), fraction);
      nanoseconds = seconds * 1'000'000'000 + fraction + (round_up ? 1 : 0);
      if (negative) nanoseconds = -nanoseconds;
      return true;
    }
  }
  double value = 0;
  if (!parse_double(text, value) || std::abs(value) > 1e-9 * kFarthestStamp) return false;
  nanoseconds = static_cast<std::int64_t>(std::llround(value * 1e9));
  return true;
}

}  // namespace groundloop
