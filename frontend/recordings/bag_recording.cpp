#include "frontend/recordings/bag_recording.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <optional>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/ground_truth.hpp"
#include "frontend/recordings/point_times.hpp"
#include "frontend/recordings/source_tools.hpp"

namespace groundloop::recordings {

bool Topic::is_point_cloud() const {
  return type == "sensor_msgs/PointCloud2" || type == "sensor_msgs/msg/PointCloud2";
}

void Topic::count(Nanoseconds time) {
  first = messages == 0 ? time : std::min(first, time);
  last = messages == 0 ? time : std::max(last, time);
  ++messages;
}

namespace {

constexpr std::size_t kWhole = std::numeric_limits<std::size_t>::max();
constexpr std::size_t kHead = 1024;  // holds the header with any frame name in use

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

std::string list(const std::vector<Topic>& topics, bool clouds_only) {
  std::string text;
  for (const Topic& topic : topics) {
    if (clouds_only && !topic.is_point_cloud()) continue;
    text += (text.empty() ? "" : ", ") + describe(topic);
  }
  return text.empty() ? "none" : text;
}

std::string choose_topic(const std::string& path, const std::vector<Topic>& topics,
                         const std::string& wanted) {
  std::vector<const Topic*> clouds;
  for (const Topic& topic : topics) {
    if (topic.name == wanted && !topic.is_point_cloud()) {
      throw InputError(path + ": topic " + wanted + " is of type " + topic.type +
                       ", not PointCloud2; choose one of " + list(topics, true));
    }
    if (topic.is_point_cloud() && (wanted.empty() || topic.name == wanted)) {
      clouds.push_back(&topic);
    }
  }
  if (clouds.size() == 1) return clouds.front()->name;
  if (clouds.empty() && wanted.empty()) {
    throw InputError(path + ": has no topic of type PointCloud2; its topics are " +
                     list(topics, false));
  }
  if (clouds.empty()) {
    throw InputError(path + ": has no topic " + wanted + "; choose one of " + list(topics, true));
  }
  throw InputError(path + ": has several topics of point clouds; choose one with --topic: " +
                   list(topics, true));
}

class BagRecording final : public Recording {
 public:
  BagRecording(const std::string& path, const char* format, std::vector<NamedFile> files,
               const RecordingOptions& options, std::vector<std::string> notes)
      : files_(std::move(files)), options_(options) {
    info_.path = path;
    info_.format = format;
    info_.notes = std::move(notes);
    for (const NamedFile& named : files_) {
      const auto& more = named.file->notes();
      info_.notes.insert(info_.notes.end(), more.begin(), more.end());
    }
    topic_ = choose_topic(path, all_topics(files_), options.topic);
    gather();
    choose_stamps();
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
    Scan scan = decode_points(cloud.table.layout, cloud.data, cloud.table.count, item.stamp,
                              request, place(item));
    require_points(scan, cloud.table.count, place(item));
    return scan;
  }

 private:
  struct Item {
    Nanoseconds stamp = 0;
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
    return parse_cloud(buffer_, item.encoding, place(item));
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
          file.read(entry, kHead, buffer_);
          header = parse_cloud_header(buffer_, topic->encoding);
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
        items_.push_back({header->stamp, f, topic->encoding, entry});
      }
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
    info_.notes.push_back(std::to_string(count) + " messages are " + what + " and left out" +
                          (first.empty() ? "." : " (" + first + ")."));
  }

  void choose_stamps() {
    info_.stamp_source = "message headers";
    const bool same = std::all_of(items_.begin(), items_.end(), [&](const Item& item) {
      return item.stamp == items_.front().stamp;
    });
    if (items_.size() == 1 || !same) return;
    for (Item& item : items_) item.stamp = item.entry.log_time;
    info_.stamp_source = "times of recording";
    info_.notes.emplace_back(
        "All headers have the same stamp; the times of recording are used instead.");
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
      survey.add(cloud.table.layout, cloud.data, cloud.table.count, item.stamp, place(item));
    }
    times_ = survey.finish({duration_, true, options_.time_unit}, info_);
  }

  // Bags hold none; a file of a usual name in the folder of bags is taken.
  void find_truth(const std::string& path) {
    std::error_code error;
    if (!std::filesystem::is_directory(path, error)) return;
    const std::filesystem::path file = find_ground_truth({path});
    if (file.empty()) return;
    std::vector<Nanoseconds> stamps;
    for (const Item& item : items_) stamps.push_back(item.stamp);
    ground_truth_ = read_ground_truth(file, stamps);
    info_.notes.push_back("Ground truth is " + file.filename().string() +
                          ", taken to be of the LiDAR itself.");
  }

  RecordingInfo info_;
  Trajectory ground_truth_;
  std::vector<NamedFile> files_;
  RecordingOptions options_;
  std::string topic_;
  std::vector<Item> items_;
  Nanoseconds duration_ = 0;
  std::optional<TimeModel> times_;
  std::vector<std::byte> buffer_;
};

}  // namespace

std::unique_ptr<Recording> make_bag_recording(const std::string& path, const char* format,
                                              std::vector<NamedFile> files,
                                              const RecordingOptions& options,
                                              std::vector<std::string> notes) {
  return std::make_unique<BagRecording>(path, format, std::move(files), options, std::move(notes));
}

}  // namespace groundloop::recordings
