#include "frontend/recordings/text_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "frontend/core/error.hpp"

namespace groundloop::recordings {

namespace {

constexpr std::size_t kLongestLine = 1 << 16;

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == ','; }

template <typename T>
void put(std::byte*& at, T value) {
  std::memcpy(at, &value, sizeof value);
  at += sizeof value;
}

// Writes a number as `type`; false where it is none, or does not fit.
bool put_number(std::byte*& at, FieldType type, std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const char* begin = text.data();
  const char* end = begin + text.size();
  const auto whole = [&](auto value) {
    const auto result = std::from_chars(begin, end, value);
    if (result.ec != std::errc() || result.ptr != end) {
      // Whole numbers are written as "12.0" or "1e6" at times.
      double real = 0.0;
      const auto second = std::from_chars(begin, end, real);
      using T = decltype(value);
      if (second.ec != std::errc() || second.ptr != end ||
          !(real >= static_cast<double>(std::numeric_limits<T>::min()) &&
            real < static_cast<double>(std::numeric_limits<T>::max()))) {
        return false;
      }
      value = static_cast<T>(real);
    }
    put(at, value);
    return true;
  };
  switch (type) {
    case FieldType::int8:
      return whole(std::int8_t{});
    case FieldType::uint8:
      return whole(std::uint8_t{});
    case FieldType::int16:
      return whole(std::int16_t{});
    case FieldType::uint16:
      return whole(std::uint16_t{});
    case FieldType::int32:
      return whole(std::int32_t{});
    case FieldType::uint32:
      return whole(std::uint32_t{});
    case FieldType::int64:
      return whole(std::int64_t{});
    case FieldType::uint64:
      return whole(std::uint64_t{});
    default:
      break;
  }
  double value = 0.0;  // from_chars reads nan and inf, too
  const auto result = std::from_chars(begin, end, value);
  if (result.ptr != end || result.ec == std::errc::invalid_argument) return false;
  if (type == FieldType::float32) {
    put(at, static_cast<float>(value));
  } else {
    put(at, value);
  }
  return true;
}

}  // namespace

bool LineReader::next(std::string_view& line) {
  if (position_ >= text_.size()) return false;
  const std::string_view rest = text_.substr(position_, kLongestLine);
  const std::size_t end = rest.find('\n');
  if (end == std::string_view::npos && rest.size() == kLongestLine) return false;
  line = rest.substr(0, end);
  position_ += std::min(line.size() + 1, rest.size());
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  ++line_;
  return true;
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  std::size_t i = 0;
  while (i < line.size()) {
    while (i < line.size() && is_space(line[i])) ++i;
    std::size_t end = i;
    while (end < line.size() && !is_space(line[end])) ++end;
    if (end > i) words.push_back(line.substr(i, end - i));
    i = end;
  }
  return words;
}

std::size_t parse_count(std::string_view text, const std::string& where) {
  std::size_t value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size()) {
    throw InputError(where + "'" + std::string(text) + "' is no whole number that fits");
  }
  return value;
}

std::vector<std::byte> parse_text_records(std::span<const std::byte> bytes, std::size_t begin,
                                          std::size_t count, const PointLayout& layout,
                                          const std::vector<std::size_t>& columns,
                                          const std::string& where) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  // Every value takes two characters at least; this bounds the memory by the file's size.
  std::size_t values = 0;
  for (const std::size_t n : columns) values += n;
  const std::size_t shortest = 2 * std::max<std::size_t>(values, 1);
  if (count > (bytes.size() - begin) / shortest + 1) {
    throw InputError(where + ": " + std::to_string(count) + " points are announced, but only " +
                     std::to_string(bytes.size() - begin) + " bytes follow; it is cut off");
  }
  std::vector<std::byte> records(count * layout.packed_size);
  std::byte* at = records.data();
  std::size_t position = begin;
  for (std::size_t row = 0; row < count; ++row) {
    for (std::size_t f = 0; f < columns.size(); ++f) {
      for (std::size_t k = 0; k < columns[f]; ++k) {
        while (position < text.size() && (is_space(text[position]) || text[position] == '\n')) {
          ++position;
        }
        std::size_t end = position;
        while (end < text.size() && !is_space(text[end]) && text[end] != '\n') ++end;
        if (end == position) {
          throw InputError(where + ": ends after " + std::to_string(row) + " of " +
                           std::to_string(count) + " points; it is cut off");
        }
        if (!put_number(at, layout.fields[f].type, text.substr(position, end - position))) {
          throw InputError(
              where + ": '" +
              std::string(text.substr(position, std::min<std::size_t>(end - position, 40))) +
              "' in field '" + layout.fields[f].name + "' of point " + std::to_string(row) +
              " is no " + to_string(layout.fields[f].type));
        }
        position = end;
      }
    }
  }
  return records;
}

}  // namespace groundloop::recordings
