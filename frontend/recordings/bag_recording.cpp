#include "frontend/recordings/bag_recording.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <optional>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/livox_message.hpp"
#include "frontend/recordings/packets/packet_recording.hpp"
#include "frontend/recordings/point_times.hpp"
#include "frontend/recordings/source_tools.hpp"
#include "frontend/recordings/truth_conventions.hpp"

namespace groundloop::recordings {

bool Topic::is_point_cloud() const {
  return type == "sensor_msgs/PointCloud2" || type == "sensor_msgs/msg/PointCloud2" ||
         is_livox_message(type);
}

bool Topic::is_packets() const { return packet_message_of(type) != PacketMessage::none; }

bool Topic::is_read() const {
  const bool text = type == "std_msgs/String" || type == "std_msgs/msg/String";
  return is_point_cloud() || is_packets() || (text && name.ends_with("metadata"));
}

void Topic::count(Nanoseconds time) {
  first = messages == 0 ? time : std::min(first, time);
  last = messages == 0 ? time : std::max(last, time);
  ++messages;
}

std::string cut_off_warning(const std::filesystem::path& file, std::uint64_t from,
                            std::uint64_t size) {
  return file.filename().string() + " is cut off or broken from byte " + std::to_string(from) +
         " of " + std::to_string(size) + " on; what stands before is used.";
}

namespace {

constexpr std::size_t kWhole = std::numeric_limits<std::size_t>::max();

std::vector<Topic> all_topics(const std::vector<NamedFile>& files) {
  std::vector<Topic> topics;
  for (const NamedFile& named : files) {
    for (const Topic& topic : named.file->topics()) {
      const auto same = std::find_if(topics.begin(), topics.end(),
                                     [&](const Topic& t) { return t.name == topic.name; });
      if (same == topics.end()) {
        topics.push_back(topic);
      } else if (topic.messages > 0) {
        same->first = same->messages == 0 ? topic.first : std::min(same->first, topic.first);
        same->last = same->messages == 0 ? topic.last : std::max(same->last, topic.last);
        same->messages += topic.messages;
      }
    }
  }
  std::sort(topics.begin(), topics.end(),
            [](const Topic& a, const Topic& b) { return a.name < b.name; });
  return topics;
}

std::string describe(const Topic& topic) {
  std::array<char, 64> rate{};
  const double seconds = 1e-9 * static_cast<double>(topic.last - topic.first);
  if (topic.messages > 1 && seconds > 0.0) {
    std::snprintf(rate.data(), rate.size(), ", %.1f Hz",
                  static_cast<double>(topic.messages - 1) / seconds);
  }
  return topic.name + " (" + topic.type + ", " + std::to_string(topic.messages) + " messages" +
         rate.data() + ")";
}

std::string list(const std::vector<Topic>& topics, bool scans_only) {
  std::string text;
  for (const Topic& topic : topics) {
    if (scans_only && !topic.is_point_cloud() && !topic.is_packets()) continue;
    text += (text.empty() ? "" : ", ") + describe(topic);
  }
  return text.empty() ? "none" : text;
}

// What makes scans of topics that cannot be read.
std::string remedy(const std::vector<Topic>& topics) {
  for (const Topic& topic : topics) {
    const auto has = [&](const char* text) { return topic.type.find(text) != std::string::npos; };
    if (has("rslidar") || has("robosense"))
      return "; convert Robosense packets to PointCloud2 with rslidar_sdk";
    if (has("LaserScan")) return "; a LaserScan is flat, which is not enough";
  }
  return "; PointCloud2, Livox CustomMsg and packets of Velodyne, Hesai and Ouster are read";
}

// Topics that may be meant; of an Ouster's packets those that are the lidar's.
std::vector<const Topic*> candidates(const std::vector<Topic>& topics) {
  std::vector<const Topic*> clouds, packets;
  for (const Topic& topic : topics) {
    if (topic.is_point_cloud()) clouds.push_back(&topic);
    const bool imu = packet_message_of(topic.type) == PacketMessage::ouster_packet &&
                     topic.name.find("imu") != std::string::npos;
    if (topic.is_packets() && !imu) packets.push_back(&topic);
  }
  return clouds.empty() ? packets : clouds;
}

Topic choose_topic(const std::string& path, const std::vector<Topic>& topics,
                   const std::string& wanted) {
  if (!wanted.empty()) {
    const auto it = std::find_if(topics.begin(), topics.end(),
                                 [&](const Topic& topic) { return topic.name == wanted; });
    if (it == topics.end()) {
      throw InputError(path + ": has no topic " + wanted + "; choose one of " + list(topics, true));
    }
    if (it->is_point_cloud() || it->is_packets()) return *it;
    throw InputError(path + ": topic " + wanted + " is of type " + it->type +
                     ", not PointCloud2 or packets; choose one of " + list(topics, true));
  }
  const std::vector<const Topic*> found = candidates(topics);
  if (found.size() == 1) return *found.front();
  if (found.empty()) {
    throw InputError(path + ": has no topic of type PointCloud2; its topics are " +
                     list(topics, false) + remedy(topics));
  }
  throw InputError(path + ": has several topics of point clouds; choose one with --topic: " +
                   list(topics, true));
}

// The text that an Ouster driver publishes beside the packets; empty where there is none.
std::string recorded_metadata(std::vector<NamedFile>& files) {
  std::vector<std::byte> message;
  for (NamedFile& named : files) {
    for (const Topic& topic : named.file->topics()) {
      if (topic.is_point_cloud() || topic.is_packets() || !topic.is_read()) continue;
      for (const MessageEntry& entry : named.file->messages(topic.name)) {
        named.file->read(entry, kWhole, message);
        MessageReader reader(message, topic.encoding);
        std::string text = reader.text();
        if (!reader.failed() && !text.empty()) return text;
      }
    }
  }
  return {};
}

void append(std::vector<std::string>& to, const std::vector<std::string>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

class BagRecording final : public Recording {
 public:
  BagRecording(const std::string& path, const char* format, std::vector<NamedFile> files,
               const RecordingOptions& options, std::vector<std::string> notes, const Topic& topic)
      : files_(std::move(files)),
        options_(options),
        topic_(topic.name),
        livox_(is_livox_message(topic.type)) {
    info_.path = path;
    info_.format = format;
    info_.notes = std::move(notes);
    for (const NamedFile& named : files_) {
      append(info_.notes, named.file->notes());
      append(info_.warnings, named.file->warnings());
    }
    gather();
    choose_stamps();
    bridge_clock_set_back();
    put_in_order();
    learn_layout();
    find_truth(path);
  }

  const RecordingInfo& info() const override { return info_; }
  std::size_t size() const override { return items_.size(); }
  Nanoseconds stamp(std::size_t index) const override { return items_.at(index).stamp; }
  Trajectory ground_truth() const override { return ground_truth_; }

  Scan read(std::size_t index) override {
    const Item& item = items_.at(index);
    const Cloud cloud = load(item);
    const DecodeRequest request{times_ ? &*times_ : nullptr, options_.attributes, nullptr};
    Scan scan = decode_points(cloud.table.layout, cloud.data, cloud.table.count, item.clock,
                              request, place(item));
    scan.stamp = item.stamp;
    require_points(scan, cloud.table.count, place(item));
    return scan;
  }

 private:
  struct Item {
    Nanoseconds stamp = 0;
    Nanoseconds clock = 0;  // the same by the clock that times of points may be of
    std::size_t file = 0;
    Encoding encoding = Encoding::ros1;
    MessageEntry entry;
  };

  std::string place(const Item& item) const {
    return files_[item.file].name + ": topic " + topic_ + ", message at " +
           seconds_text(item.stamp) + " s";
  }

  Cloud load(const Item& item) {
    files_[item.file].file->read(item.entry, kWhole, buffer_);
    return livox_ ? parse_livox(buffer_, item.encoding, place(item))
                  : parse_cloud(buffer_, item.encoding, place(item));
  }

  // Every message's header, in the order of recording.
  void gather() {
    std::string first_problem;
    std::size_t broken = 0, empty = 0;
    for (std::size_t f = 0; f < files_.size(); ++f) {
      MessageFile& file = *files_[f].file;
      const auto topic = std::find_if(file.topics().begin(), file.topics().end(),
                                      [&](const Topic& t) { return t.name == topic_; });
      if (topic == file.topics().end()) continue;
      for (const MessageEntry& entry : file.messages(topic_)) {
        std::optional<CloudHeader> header;
        try {
          file.read(entry, kHeadBytes, buffer_);
          header = livox_ ? parse_livox_header(buffer_, topic->encoding)
                          : parse_cloud_header(buffer_, topic->encoding);
        } catch (const InputError& e) {
          if (first_problem.empty()) first_problem = e.what();
        }
        if (!header) {
          ++broken;
          continue;
        }
        if (header->width == 0 || header->height == 0) {
          ++empty;
          continue;
        }
        if (items_.empty()) info_.sensor = "frame " + header->frame;
        items_.push_back({header->stamp, header->stamp, f, topic->encoding, entry});
      }
      file.forget_heads();
    }
    std::stable_sort(items_.begin(), items_.end(), [](const Item& a, const Item& b) {
      return a.entry.log_time < b.entry.log_time;
    });
    note_left_out(broken, "too short for a PointCloud2 or cannot be read", first_problem);
    note_left_out(empty, "without points", "");
    if (items_.empty()) {
      throw InputError(info_.path + ": topic " + topic_ + " holds no point cloud that can be read" +
                       (first_problem.empty() ? "; record it anew" : " (" + first_problem + ")"));
    }
  }

  void note_left_out(std::size_t count, const char* what, const std::string& first) {
    if (count == 0) return;
    info_.dropped_scans += count;
    info_.warnings.push_back(std::to_string(count) + " messages are " + what + " and left out" +
                             (first.empty() ? "." : " (" + first + ")."));
  }

  void choose_stamps() {
    info_.stamp_source = "message headers";
    const bool same = std::all_of(items_.begin(), items_.end(), [&](const Item& item) {
      return item.stamp == items_.front().stamp;
    });
    if (items_.size() == 1 || !same) return;
    for (Item& item : items_) item.stamp = item.clock = item.entry.log_time;
    info_.stamp_source = "times of recording";
    info_.notes.emplace_back(
        "All headers have the same stamp; the times of recording are used instead.");
  }

  // A clock that was set back while the recording went on: the stamps behind go on from there by
  // the recorder's clock. Messages that merely come late are followed by later ones again.
  void bridge_clock_set_back() {
    constexpr Nanoseconds kSecond = 1'000'000'000;
    Nanoseconds shift = 0, latest = items_.front().stamp;
    for (std::size_t i = 1; i < items_.size(); ++i) {
      const Nanoseconds own = items_[i].stamp;
      const bool goes_on = i + 1 < items_.size() && items_[i + 1].stamp > own &&
                           items_[i + 1].stamp + shift < latest - kSecond;
      if (own + shift < latest - kSecond && goes_on) {
        const Nanoseconds passed = items_[i].entry.log_time - items_[i - 1].entry.log_time;
        shift = items_[i - 1].stamp + std::clamp<Nanoseconds>(passed, 1, 3600 * kSecond) - own;
        ++times_set_;
      }
      items_[i].stamp = own + shift;
      latest = std::max(latest, items_[i].stamp);
    }
    if (times_set_ > 0) {
      info_.warnings.push_back("The sensor's clock was set back " + std::to_string(times_set_) +
                               (times_set_ == 1 ? " time" : " times") +
                               "; stamps go on from there by the times of recording.");
    }
  }

  void put_in_order() {
    Nanoseconds latest = items_.front().stamp;
    for (const Item& item : items_) {
      if (item.stamp < latest) ++info_.out_of_order;
      latest = std::max(latest, item.stamp);
    }
    std::stable_sort(items_.begin(), items_.end(),
                     [](const Item& a, const Item& b) { return a.stamp < b.stamp; });
    const auto end = std::unique(items_.begin(), items_.end(),
                                 [](const Item& a, const Item& b) { return a.stamp == b.stamp; });
    info_.duplicates = static_cast<std::size_t>(items_.end() - end);
    info_.dropped_scans += info_.duplicates;
    items_.erase(end, items_.end());
    if (info_.out_of_order > 0) {
      info_.notes.push_back(std::to_string(info_.out_of_order) +
                            " scans were recorded out of order and are sorted by stamp.");
    }
    if (info_.duplicates > 0) {
      info_.notes.push_back(std::to_string(info_.duplicates) +
                            " scans have the stamp of another one and are left out.");
    }
    std::vector<Nanoseconds> stamps;
    for (const Item& item : items_) stamps.push_back(item.stamp);
    info_.gaps = count_gaps(stamps);
    duration_ = scan_duration(stamps);
  }

  void learn_layout() {
    TimeSurvey survey;
    for (const std::size_t index : spread_indices(items_.size())) {
      const Item& item = items_[index];
      const Cloud cloud = load(item);
      if (info_.fields.empty()) {
        info_.fields = cloud.table.layout.described();
        info_.attributes = cloud.table.layout.attributes();
      }
      survey.add(cloud.table.layout, cloud.data, cloud.table.count, item.clock, place(item));
    }
    times_ = survey.finish({duration_, true, options_.time_unit}, info_);
  }

  // Bags hold none; a file of a usual name beside them is taken.
  void find_truth(const std::string& path) {
    std::vector<Nanoseconds> stamps;
    for (const Item& item : items_) stamps.push_back(item.stamp);
    std::error_code error;
    if (!std::filesystem::is_directory(path, error)) {
      ground_truth_ = truth_beside(path, stamps, info_);
    } else if (const auto found = recordings::find_truth(path)) {
      ground_truth_ = read_truth(*found, stamps, info_);
    }
  }

  RecordingInfo info_;
  Trajectory ground_truth_;
  std::vector<NamedFile> files_;
  RecordingOptions options_;
  std::string topic_;
  bool livox_ = false;
  std::vector<Item> items_;
  std::size_t times_set_ = 0;
  Nanoseconds duration_ = 0;
  std::optional<TimeModel> times_;
  std::vector<std::byte> buffer_;
};

}  // namespace

std::unique_ptr<Recording> make_bag_recording(const std::string& path, const char* format,
                                              std::vector<NamedFile> files,
                                              const RecordingOptions& options,
                                              std::vector<std::string> notes) {
  const Topic topic = choose_topic(path, all_topics(files), options.topic);
  if (!topic.is_packets())
    return std::make_unique<BagRecording>(path, format, std::move(files), options, std::move(notes),
                                          topic);
  PacketSource source;
  source.path = path;
  source.format = format;
  source.notes = std::move(notes);
  for (const NamedFile& named : files) {
    append(source.notes, named.file->notes());
    append(source.warnings, named.file->warnings());
  }
  source.files = std::move(files);
  const PacketMessage kind = packet_message_of(topic.type);
  if (kind == PacketMessage::ouster_packet) source.metadata = recorded_metadata(source.files);
  source.stream = open_bag_packets(source.files, topic.name, kind);
  return make_packet_recording(std::move(source), options);
}

}  // namespace groundloop::recordings
