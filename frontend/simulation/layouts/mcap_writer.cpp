// An MCAP file with zstd chunks, message indices, summary and checksums: DIR/recording.mcap.
#include <algorithm>

#include <zstd.h>

#include "frontend/core/error.hpp"
#include "frontend/recordings/compression.hpp"
#include "frontend/simulation/layouts/layout_writer.hpp"
#include "frontend/simulation/layouts/point_cloud2_writer.hpp"

namespace groundloop::layouts {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kChunkSize = 4U << 20U;
constexpr int kLevel = 1;  // coordinates hardly get smaller at higher levels
constexpr std::uint16_t kSchema = 1, kChannel = 1;

ByteWriter record(std::uint8_t opcode, const ByteWriter& content) {
  ByteWriter r;
  r.put(opcode).put_counted<std::uint64_t>(content.view());
  return r;
}

ByteWriter definitions() {
  ByteWriter schema, channel, both;
  schema.put(kSchema).put_counted<std::uint32_t>("sensor_msgs/msg/PointCloud2");
  schema.put_counted<std::uint32_t>("ros2msg");
  schema.put_counted<std::uint32_t>(point_cloud2_definition(false));
  channel.put(kChannel).put(kSchema).put_counted<std::uint32_t>("/points");
  channel.put_counted<std::uint32_t>("cdr").put_counted<std::uint32_t>("");
  both.put_text(record(0x03, schema).view()).put_text(record(0x04, channel).view());
  return both;
}

class McapWriter final : public Writer {
 public:
  McapWriter(const fs::path& folder, const Source& source)
      : file_(folder / "recording.mcap"), out_(file_, std::ios::binary | std::ios::trunc) {
    if (!source.ground_truth.empty()) write_tum(folder / "ground_truth.tum", source.ground_truth);
    ByteWriter header;
    header.put_counted<std::uint32_t>("ros2").put_counted<std::uint32_t>("groundloop");
    put(kMagic);
    put(record(0x01, header).view());
    chunk_.put_text(definitions().view());
  }

  void write(std::size_t index, const Scan& scan) override {
    if (scan.stamp < 0) throw InputError("an MCAP file cannot hold stamps before 1970");
    const auto time = static_cast<std::uint64_t>(scan.stamp);
    ByteWriter message;
    message.put(kChannel).put(static_cast<std::uint32_t>(index)).put(time).put(time);
    message.put_text(cdr_message(scan, TimeField::time_s).view());
    entries_.emplace_back(time, chunk_.size());
    chunk_.put_text(record(0x05, message).view());
    first_ = messages_ == 0 ? time : std::min(first_, time);
    last_ = std::max(last_, time);
    ++messages_;
    if (chunk_.size() >= kChunkSize) end_chunk();
  }

  void finish() override {
    if (!entries_.empty()) end_chunk();
    ByteWriter end;
    end.put<std::uint32_t>(0);  // no checksum of the whole data section
    put(record(0x0f, end).view());
    const std::uint64_t start = position_;
    ByteWriter statistics, summary;
    statistics.put(messages_).put<std::uint16_t>(1).put<std::uint32_t>(1).put<std::uint32_t>(0);
    statistics.put<std::uint32_t>(0).put(chunks_).put(first_).put(last_);
    statistics.put<std::uint32_t>(10).put(kChannel).put(messages_);
    summary.put_text(definitions().view());
    summary.put_text(record(0x0b, statistics).view()).put_text(indices_.view());
    ByteWriter footer;
    footer.put<std::uint8_t>(0x02).put<std::uint64_t>(20).put(start).put<std::uint64_t>(0);
    put(summary.view());
    footer.put(recordings::crc32(footer.bytes(), recordings::crc32(summary.bytes())));
    put(footer.view());
    put(kMagic);
    if (!out_.flush()) throw InputError(file_.string() + ": cannot be written; is the disk full?");
  }

 private:
  void put(std::string_view bytes) {
    out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    position_ += bytes.size();
  }

  void end_chunk() {
    std::vector<char> packed(ZSTD_compressBound(chunk_.size()));
    packed.resize(
        ZSTD_compress(packed.data(), packed.size(), chunk_.bytes().data(), chunk_.size(), kLevel));
    const auto [begin, end] = std::minmax_element(entries_.begin(), entries_.end());
    const std::uint64_t offset = position_;
    ByteWriter content;
    content.put(begin->first).put(end->first).put<std::uint64_t>(chunk_.size());
    content.put(recordings::crc32(chunk_.bytes())).put_counted<std::uint32_t>("zstd");
    content.put_counted<std::uint64_t>({packed.data(), packed.size()});
    put(record(0x06, content).view());
    const std::uint64_t length = position_ - offset;

    ByteWriter index;
    index.put(kChannel).put(static_cast<std::uint32_t>(16 * entries_.size()));
    for (const auto& [time, place] : entries_) index.put(time).put<std::uint64_t>(place);
    const std::uint64_t index_offset = position_;
    put(record(0x07, index).view());

    ByteWriter chunk_index;
    chunk_index.put(begin->first).put(end->first).put(offset).put(length);
    chunk_index.put<std::uint32_t>(10).put(kChannel).put(index_offset);
    chunk_index.put(position_ - index_offset).put_counted<std::uint32_t>("zstd");
    chunk_index.put<std::uint64_t>(packed.size()).put<std::uint64_t>(chunk_.size());
    indices_.put_text(record(0x08, chunk_index).view());
    ++chunks_;
    chunk_.clear();
    entries_.clear();
  }

  fs::path file_;
  std::ofstream out_;
  std::uint64_t position_ = 0;
  ByteWriter chunk_, indices_;
  std::vector<std::pair<std::uint64_t, std::size_t>> entries_;  // time and place of messages
  std::uint64_t messages_ = 0, first_ = 0, last_ = 0;
  std::uint32_t chunks_ = 0;
};

}  // namespace

std::unique_ptr<Writer> make_mcap_writer(const fs::path& folder, const Source& source) {
  return std::make_unique<McapWriter>(folder, source);
}

}  // namespace groundloop::layouts
