#include <algorithm>
#include <cstring>
#include <optional>

#include "frontend/core/error.hpp"
#include "frontend/recordings/lzf.hpp"
#include "frontend/recordings/point_files.hpp"
#include "frontend/recordings/text_table.hpp"

namespace groundloop::recordings {

namespace {

struct PcdHeader {
  std::vector<std::string> names;
  std::vector<FieldType> types;
  std::vector<std::size_t> counts;
  std::size_t points = 0;
  std::string data;
  std::size_t begin = 0;
};

std::optional<FieldType> type_of(std::string_view kind, std::size_t size) {
  if (kind == "F") {
    if (size == 4) return FieldType::float32;
    if (size == 8) return FieldType::float64;
  }
  const bool is_signed = kind == "I";
  if (is_signed || kind == "U") {
    switch (size) {
      case 1:
        return is_signed ? FieldType::int8 : FieldType::uint8;
      case 2:
        return is_signed ? FieldType::int16 : FieldType::uint16;
      case 4:
        return is_signed ? FieldType::int32 : FieldType::uint32;
      case 8:
        return is_signed ? FieldType::int64 : FieldType::uint64;
      default:
        break;
    }
  }
  return std::nullopt;
}

PcdHeader parse_header(std::span<const std::byte> bytes, const std::string& where) {
  LineReader lines(bytes);
  PcdHeader header;
  std::vector<std::size_t> sizes;
  std::vector<std::string> kinds;
  std::size_t width = 0, height = 1;
  std::optional<std::size_t> points;
  std::string_view line;
  while (header.data.empty() && lines.next(line)) {
    const std::vector<std::string_view> words = split(line);
    if (words.empty() || words[0].front() == '#') continue;
    const std::string place = where + ":" + std::to_string(lines.line_number()) + ": ";
    const std::string_view key = words[0];
    if (words.size() < 2) throw InputError(place + "'" + std::string(key) + "' has no value");
    if (key == "FIELDS" || key == "COLUMNS") {
      header.names.assign(words.begin() + 1, words.end());
    } else if (key == "SIZE" || key == "COUNT") {
      auto& list = key == "SIZE" ? sizes : header.counts;
      list.clear();
      for (std::size_t i = 1; i < words.size(); ++i) list.push_back(parse_count(words[i], place));
    } else if (key == "TYPE") {
      kinds.assign(words.begin() + 1, words.end());
    } else if (key == "WIDTH") {
      width = parse_count(words[1], place);
    } else if (key == "HEIGHT") {
      height = parse_count(words[1], place);
    } else if (key == "POINTS") {
      points = parse_count(words[1], place);
    } else if (key == "DATA") {
      header.data = words[1];
    } else if (key != "VERSION" && key != "VIEWPOINT") {
      throw InputError(place + "'" + std::string(key.substr(0, 40)) +
                       "' is no entry of a PCD header; is this a PCD file?");
    }
  }
  if (header.data.empty()) throw InputError(where + ": has no line DATA; it is cut off or no PCD");
  if (header.names.empty()) throw InputError(where + ": has no line FIELDS");
  if (header.counts.empty()) header.counts.assign(header.names.size(), 1);
  if (sizes.size() != header.names.size() || kinds.size() != sizes.size() ||
      header.counts.size() != sizes.size()) {
    throw InputError(where + ": FIELDS, SIZE, TYPE and COUNT differ in length");
  }
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const auto type = type_of(kinds[i], sizes[i]);
    if (!type || header.counts[i] == 0 || header.counts[i] > 100'000) {
      throw InputError(where + ": field '" + header.names[i] + "' has type " + kinds[i] +
                       ", size " + std::to_string(sizes[i]) + " and count " +
                       std::to_string(header.counts[i]) + ", which is none that PCD knows");
    }
    header.types.push_back(*type);
  }
  std::size_t product = 0;
  if (__builtin_mul_overflow(width, height, &product)) {
    throw InputError(where + ": WIDTH x HEIGHT is absurd");
  }
  header.points = points.value_or(product);
  if (width != 0 && header.points != product) {
    throw InputError(where + ": POINTS " + std::to_string(header.points) +
                     " differs from WIDTH x HEIGHT " + std::to_string(product));
  }
  header.begin = lines.position();
  return header;
}

// Replaces the bytes by the decompressed columns.
void decompress(std::vector<std::byte>& bytes, std::size_t begin, std::size_t size,
                const std::string& where) {
  std::uint32_t compressed = 0, uncompressed = 0;
  if (bytes.size() - begin < 8) throw InputError(where + ": ends before its compressed points");
  std::memcpy(&compressed, bytes.data() + begin, 4);
  std::memcpy(&uncompressed, bytes.data() + begin + 4, 4);
  if (uncompressed != size) {
    throw InputError(where + ": holds " + std::to_string(uncompressed) +
                     " bytes of points, its "
                     "header announces " +
                     std::to_string(size));
  }
  if (compressed > bytes.size() - begin - 8) {
    throw InputError(where + ": " + std::to_string(bytes.size() - begin - 8) + " of " +
                     std::to_string(compressed) + " compressed bytes are there; it is cut off");
  }
  // Three bytes of LZF expand to at most 264.
  if (uncompressed / 88 > compressed + 1)
    throw InputError(where + ": its compressed data are broken");
  std::vector<std::byte> out(size);
  if (!lzf_decompress(std::span(bytes).subspan(begin + 8, compressed), out)) {
    throw InputError(where + ": its compressed data are broken");
  }
  bytes = std::move(out);
}

}  // namespace

PointTable parse_pcd(std::vector<std::byte>& bytes, const std::string& where) {
  const PcdHeader header = parse_header(bytes, where);
  PointTable table;
  table.count = header.points;
  for (std::size_t i = 0; i < header.names.size(); ++i) {
    table.layout.append(header.names[i], header.types[i], header.counts[i]);
  }
  const std::size_t step = table.layout.packed_size;
  std::size_t size = 0;
  if (__builtin_mul_overflow(table.count, step, &size)) {
    throw InputError(where + ": " + std::to_string(table.count) + " points are absurd");
  }
  if (header.data == "ascii") {
    bytes =
        parse_text_records(bytes, header.begin, table.count, table.layout, header.counts, where);
    table.layout.set_records(0);
  } else if (header.data == "binary") {
    if (size > bytes.size() - header.begin) {
      throw InputError(where + ": " + std::to_string(bytes.size() - header.begin) + " of " +
                       std::to_string(size) + " bytes of points are there; it is cut off");
    }
    table.layout.set_records(header.begin);
  } else if (header.data == "binary_compressed") {
    decompress(bytes, header.begin, size, where);
    // One column after the other.
    std::size_t offset = 0;
    for (std::size_t i = 0; i < header.counts.size(); ++i) {
      PointField& field = table.layout.fields[i];
      field.offset = offset;
      field.stride = size_of(field.type) * header.counts[i];
      offset += field.stride * table.count;
    }
  } else {
    throw InputError(where + ": DATA " + header.data +
                     " is unknown; expected ascii, binary or binary_compressed");
  }
  return table;
}

}  // namespace groundloop::recordings
