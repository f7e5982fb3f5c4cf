#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "frontend/core/error.hpp"
#include "frontend/recordings/point_files.hpp"
#include "frontend/recordings/text_table.hpp"

namespace groundloop::recordings {

namespace {

struct Element {
  std::string name;
  std::size_t count = 0;
  PointLayout layout;
  bool has_list = false;
};

struct PlyHeader {
  std::string format;
  std::vector<Element> elements;
  std::size_t begin = 0;
};

std::optional<FieldType> type_of(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, FieldType>, 18> types = {{
      {"char", FieldType::int8},
      {"int8", FieldType::int8},
      {"uchar", FieldType::uint8},
      {"uint8", FieldType::uint8},
      {"short", FieldType::int16},
      {"int16", FieldType::int16},
      {"ushort", FieldType::uint16},
      {"uint16", FieldType::uint16},
      {"int", FieldType::int32},
      {"int32", FieldType::int32},
      {"uint", FieldType::uint32},
      {"uint32", FieldType::uint32},
      {"float", FieldType::float32},
      {"float32", FieldType::float32},
      {"double", FieldType::float64},
      {"float64", FieldType::float64},
      {"int64", FieldType::int64},
      {"uint64", FieldType::uint64},
  }};
  for (const auto& [text, type] : types) {
    if (text == name) return type;
  }
  return std::nullopt;
}

void parse_property(const std::vector<std::string_view>& words, Element& element,
                    const std::string& place) {
  if (words.size() >= 5 && words[1] == "list") {
    element.has_list = true;
    return;
  }
  const auto type = words.size() == 3 ? type_of(words[1]) : std::nullopt;
  if (!type) throw InputError(place + "a property needs a PLY type and a name");
  element.layout.append(std::string(words[2]), *type);
}

PlyHeader parse_header(std::span<const std::byte> bytes, const std::string& where) {
  LineReader lines(bytes);
  std::string_view line;
  if (!lines.next(line) || line != "ply") {
    throw InputError(where + ": does not begin with 'ply'; is this a PLY file?");
  }
  PlyHeader header;
  while (header.begin == 0) {
    if (!lines.next(line)) throw InputError(where + ": has no end_header; it is cut off");
    const std::vector<std::string_view> words = split(line);
    const std::string place = where + ":" + std::to_string(lines.line_number()) + ": ";
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "format" && words.size() >= 2) {
      header.format = words[1];
    } else if (words[0] == "element" && words.size() == 3) {
      header.elements.push_back({std::string(words[1]), parse_count(words[2], place), {}, false});
    } else if (words[0] == "property" && !header.elements.empty()) {
      parse_property(words, header.elements.back(), place);
    } else if (words[0] == "end_header") {
      header.begin = lines.position();
    } else {
      throw InputError(place + "'" + std::string(line.substr(0, 40)) +
                       "' is no line of a PLY header");
    }
  }
  return header;
}

}  // namespace

PointTable parse_ply(std::vector<std::byte>& bytes, const std::string& where) {
  const PlyHeader header = parse_header(bytes, where);
  const bool text = header.format == "ascii";
  const bool big = header.format == "binary_big_endian";
  if (!text && !big && header.format != "binary_little_endian") {
    throw InputError(where + ": format '" + header.format +
                     "' is unknown; expected ascii, binary_little_endian or binary_big_endian");
  }
  std::size_t position = header.begin;
  for (const Element& element : header.elements) {
    const bool vertices = element.name == "vertex";
    if (element.has_list) {
      throw InputError(where + ": element '" + element.name +
                       "' has a list property before or among the vertices, which scans have not");
    }
    std::size_t size = 0;
    if (__builtin_mul_overflow(element.count, element.layout.packed_size, &size) ||
        (!text && size > bytes.size() - position)) {
      throw InputError(where + ": " + std::to_string(bytes.size() - position) +
                       " bytes are there for " + std::to_string(element.count) + " of element '" +
                       element.name + "'; it is cut off");
    }
    if (!vertices) {
      LineReader lines(std::span<const std::byte>(bytes).subspan(position));
      std::string_view line;
      for (std::size_t i = 0; text && i < element.count && lines.next(line);) ++i;
      position += text ? lines.position() : size;
      continue;
    }
    PointTable table;
    table.layout = element.layout;
    table.layout.big_endian = big;
    table.count = element.count;
    if (text) {
      const std::vector<std::size_t> columns(element.layout.fields.size(), 1);
      bytes = parse_text_records(bytes, position, table.count, table.layout, columns, where);
      position = 0;
    }
    table.layout.set_records(position);
    return table;
  }
  throw InputError(where + ": has no element 'vertex'; a scan needs one");
}

}  // namespace groundloop::recordings
