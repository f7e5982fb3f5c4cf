// A ROS 1 bag of PointCloud2 or of Livox' CustomMsg, written by librosbag_storage with LZ4:
// DIR/recording.bag.
#include <rosbag/bag.h>

#include "frontend/core/error.hpp"
#include "frontend/simulation/layouts/layout_writer.hpp"
#include "frontend/simulation/layouts/livox_writer.hpp"
#include "frontend/simulation/layouts/point_cloud2_writer.hpp"

namespace groundloop::layouts {

namespace {
/// How messages of a bag are named.
struct MessageType {
  const char* topic;
  const char* type;
  const char* md5;
  const std::string& (*definition)();
};
/// A message that is serialised already.
struct SerializedCloud {
  std::string_view bytes;
  const MessageType& type;
};
}  // namespace

}  // namespace groundloop::layouts

// What librosbag_storage asks of a message type.
namespace ros {
namespace message_traits {
using groundloop::layouts::SerializedCloud;
template <>
struct IsMessage<SerializedCloud> : TrueType {};
template <>
struct MD5Sum<SerializedCloud> {
  static const char* value(const SerializedCloud& cloud) { return cloud.type.md5; }
};
template <>
struct DataType<SerializedCloud> {
  static const char* value(const SerializedCloud& cloud) { return cloud.type.type; }
};
template <>
struct Definition<SerializedCloud> {
  static const char* value(const SerializedCloud& cloud) { return cloud.type.definition().c_str(); }
};
}  // namespace message_traits
namespace serialization {
template <>
struct Serializer<groundloop::layouts::SerializedCloud> {
  template <typename Stream>
  static void write(Stream& stream, const groundloop::layouts::SerializedCloud& cloud) {
    std::memcpy(stream.advance(static_cast<std::uint32_t>(cloud.bytes.size())), cloud.bytes.data(),
                cloud.bytes.size());
  }
  static std::uint32_t serializedLength(const groundloop::layouts::SerializedCloud& cloud) {
    return static_cast<std::uint32_t>(cloud.bytes.size());
  }
};
}  // namespace serialization
}  // namespace ros

namespace groundloop::layouts {
namespace fs = std::filesystem;

namespace {

const MessageType kCloud = {"/points", "sensor_msgs/PointCloud2",
                            "1158d486dd51d683ce2f1be655c3c181",
                            []() -> const std::string& { return point_cloud2_definition(true); }};
const MessageType kLivox = {"/livox/lidar", "livox_ros_driver/CustomMsg", kLivoxMd5,
                            livox_definition};

class RosbagWriter final : public Writer {
 public:
  RosbagWriter(const fs::path& folder, const Source& source, const MessageType& type)
      : file_(folder / "recording.bag"), type_(type) {
    if (!source.ground_truth.empty()) write_tum(folder / "ground_truth.tum", source.ground_truth);
    guarded([&] {
      bag_.open(file_.string(), rosbag::bagmode::Write);
      bag_.setCompression(rosbag::compression::LZ4);
    });
  }

  void write(std::size_t index, const Scan& scan) override {
    const auto sequence = static_cast<std::uint32_t>(index);
    const ByteWriter message = &type_ == &kLivox ? livox_message(scan, sequence)
                                                 : ros1_message(scan, TimeField::t_ns, sequence);
    const ros::Time time(static_cast<std::uint32_t>(scan.stamp / 1'000'000'000),
                         static_cast<std::uint32_t>(scan.stamp % 1'000'000'000));
    guarded([&] { bag_.write(type_.topic, time, SerializedCloud{message.view(), type_}); });
  }

  void finish() override {
    guarded([&] { bag_.close(); });
  }

 private:
  template <typename F>
  void guarded(F&& f) {
    try {
      f();
    } catch (const rosbag::BagException& e) {
      throw InputError(file_.string() + ": cannot be written (" + e.what() + ")");
    }
  }
  fs::path file_;
  const MessageType& type_;
  rosbag::Bag bag_;
};

}  // namespace

std::unique_ptr<Writer> make_rosbag_writer(const fs::path& folder, const Source& source) {
  return std::make_unique<RosbagWriter>(folder, source, kCloud);
}

std::unique_ptr<Writer> make_livox_writer(const fs::path& folder, const Source& source) {
  return std::make_unique<RosbagWriter>(folder, source, kLivox);
}

}  // namespace groundloop::layouts
