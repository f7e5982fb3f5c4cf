#include "apps/commands/reference_file.hpp"

#include <string_view>

#include "backend/session/table_row.hpp"
#include "frontend/core/checksum.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop::apps {
namespace {

constexpr std::string_view kFirstLine = "# groundloop references 1 of ";
constexpr const char* kHeader =
    "reference_session,reference_map,query_session,query_map,overlap,reference,uncertain,direction,"
    "distance_m\n";
constexpr TravelDirection kDirections[] = {TravelDirection::same, TravelDirection::opposite,
                                           TravelDirection::crossing, TravelDirection::apart};

TravelDirection direction_from(const TableRow& row, std::size_t field) {
  for (const TravelDirection d : kDirections) {
    if (row.text(field) == to_string(d)) return d;
  }
  row.fail("'" + row.text(field) + "' is no direction; remove the file");
}

int part_of(const TableRow& row, std::size_t field, const std::vector<EvaluatedPart>& parts) {
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (parts[p].name == row.text(field)) return static_cast<int>(p);
  }
  row.fail("no session is called '" + row.text(field) + "'; remove the file");
}

}  // namespace

std::uint64_t reference_fingerprint(const std::vector<EvaluatedPart>& parts,
                                    const std::vector<EvaluatedMap>& maps,
                                    const ReferenceOptions& options) {
  std::string text = options.align ? "icp" : "truth";
  text += " " + options.pairs + " " + std::to_string(options.skipped_maps);
  for (const EvaluatedPart& part : parts) {
    text += " " + part.recording;
    for (const LocalMapRecord& map : part.maps) {
      text += " " + std::to_string(part.odometry[map.first_scan].stamp) + "-" +
              std::to_string(part.odometry[map.last_scan].stamp);
    }
  }
  for (const EvaluatedMap& map : maps) {
    for (const Pose& pose : map.T_world_scan) append_pose(text, pose);
  }
  return checksum(std::string_view(text));
}

void write_references(const std::filesystem::path& file, const std::vector<EvaluatedPart>& parts,
                      const std::vector<PairOverlap>& pairs, const ReferenceOptions& options,
                      std::uint64_t fingerprint) {
  std::string text = std::string(kFirstLine) + std::to_string(fingerprint) + "\n" + kHeader;
  const auto name = [&](const MapKey& key) {
    return quoted(parts[static_cast<std::size_t>(key.session)].name) + "," +
           std::to_string(key.map);
  };
  for (const PairOverlap& pair : pairs) {
    text += name(pair.reference) + "," + name(pair.query) + "," + to_text(pair.overlap) + "," +
            (is_reference(pair, options) ? "1," : "0,") +
            (is_uncertain(pair, options) ? "1," : "0,") + to_string(pair.direction) + "," +
            to_text(pair.distance) + "\n";
  }
  std::filesystem::create_directories(std::filesystem::absolute(file).parent_path());
  write_text_atomically(file, text);
}

std::optional<std::vector<PairOverlap>> read_references(const std::filesystem::path& file,
                                                        const std::vector<EvaluatedPart>& parts,
                                                        std::uint64_t fingerprint) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  const std::string text = read_text(file);
  const std::string first = std::string(kFirstLine) + std::to_string(fingerprint) + "\n" + kHeader;
  if (text.rfind(first, 0) != 0) return std::nullopt;
  std::vector<PairOverlap> pairs;
  for_each_row(file, text, 2, [&](const TableRow& row) {
    row.expect_fields(9);
    pairs.push_back({{part_of(row, 0, parts), row.integer<int>(1)},
                     {part_of(row, 2, parts), row.integer<int>(3)},
                     row.number(4),
                     direction_from(row, 7),
                     row.number(8)});
  });
  return pairs;
}

}  // namespace groundloop::apps
