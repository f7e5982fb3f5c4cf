#include "frontend/recordings/scan_files.hpp"

#include <algorithm>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

std::size_t records_of(const fs::path& file, std::uintmax_t bytes, std::size_t record,
                       const char* fields) {
  if (bytes % record != 0) {
    throw InputError(file.string() + ": " + std::to_string(bytes) + " bytes are no multiple of " +
                     std::to_string(record) + " (" + fields +
                     "); the file is cut off or of another format");
  }
  return bytes / record;
}

}  // namespace

ScanFiles::ScanFiles(const fs::path& path, const char* format, const fs::path& folder,
                     const char* extension, const RecordingOptions& options)
    : ScanFiles(path, format, options) {
  files_ = list_files(folder, extension);
  if (files_.empty()) {
    throw InputError(folder.string() + ": holds no scan; expected *" + extension + " files");
  }
}

ScanFiles::ScanFiles(const fs::path& path, const char* format, const RecordingOptions& options)
    : attributes_(options.attributes) {
  info_.path = path.string();
  info_.format = format;
}

Scan ScanFiles::read(std::size_t index) {
  const fs::path& file = files_.at(index);
  read_file_into(file, buffer_);
  Scan scan;
  scan.stamp = stamps_.at(index);
  const std::size_t seen = decode(index, scan);
  require_points(scan, seen, file.string());
  return scan;
}

std::size_t ScanFiles::decode_table(std::size_t index, const PointTable& table,
                                    DecodeRequest request, Scan& scan) const {
  request.attributes = attributes_;
  scan = decode_points(table.layout, buffer_, table.count, stamps_[index], request,
                       files_[index].string());
  return table.count;
}

void ScanFiles::take_stamps_from_names(Nanoseconds nanoseconds, const char* unit) {
  std::vector<std::pair<Nanoseconds, fs::path>> stamped;
  for (const fs::path& file : files_) {
    const auto number = numeric_stem(file);
    if (!number || *number > kFarthestStamp / nanoseconds) {
      throw InputError(file.string() + ": its name is no stamp in " + unit +
                       "; remove it or give --format");
    }
    stamped.emplace_back(*number * nanoseconds, file);
  }
  std::sort(stamped.begin(), stamped.end());
  stamps_.clear();
  for (std::size_t i = 0; i < stamped.size(); ++i) {
    files_[i] = stamped[i].second;
    stamps_.push_back(stamped[i].first);
    if (i > 0 && stamps_[i] == stamps_[i - 1]) {
      throw InputError(files_[i].string() + ": has the stamp of " + files_[i - 1].string());
    }
  }
  info_.stamp_source = std::string("file names (") + unit + ")";
  info_.gaps = count_gaps(stamps_);
}

void ScanFiles::check_length(std::size_t index, std::size_t record, const char* fields) const {
  const fs::path& file = files_.at(index);
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (error) throw InputError(file.string() + ": cannot be read: " + error.message());
  if (records_of(file, bytes, record, fields) == 0) require_points({}, 0, file.string());
}

void ScanFiles::check_lengths(std::size_t record, const char* fields) {
  std::size_t broken = 0;
  std::string first;
  for (std::size_t i = 0; i + 1 < files_.size(); ++i) {
    try {
      check_length(i, record, fields);
    } catch (const InputError& e) {
      if (broken++ == 0) first = e.what();
    }
  }
  // A length that most files do not fit is that of another record.
  if (2 * broken > files_.size()) throw InputError(first);
  if (broken > 0) {
    info_.warnings.push_back(std::to_string(broken) +
                             (broken == 1 ? " scan" : " scans, the first of them named here,") +
                             " cannot be used: " + first + ".");
  }
  check_last([&](std::size_t i) { check_length(i, record, fields); });
}

void ScanFiles::leave_out_last(const std::string& why) {
  info_.warnings.push_back("The last scan is left out, as if recording was interrupted: " + why +
                           ".");
  ++info_.dropped_scans;
  if (stamps_.size() == files_.size()) {
    left_out_ = stamps_.back();
    stamps_.pop_back();
  }
  files_.pop_back();
}

std::vector<Nanoseconds> ScanFiles::all_stamps() const {
  std::vector<Nanoseconds> all = stamps_;
  if (left_out_) all.push_back(*left_out_);
  return all;
}

std::size_t ScanFiles::record_count(std::size_t index, std::size_t record,
                                    const char* fields) const {
  return records_of(files_.at(index), buffer_.size(), record, fields);
}

}  // namespace groundloop::recordings
