// A recording of one file a scan: what the readers of such layouts share.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "frontend/core/error.hpp"
#include "frontend/recordings/point_times.hpp"
#include "frontend/recordings/recording.hpp"
#include "frontend/recordings/source_tools.hpp"

namespace groundloop::recordings {

class ScanFiles : public Recording {
 public:
  [[nodiscard]] const RecordingInfo& info() const final { return info_; }
  [[nodiscard]] std::size_t size() const final { return files_.size(); }
  [[nodiscard]] Nanoseconds stamp(std::size_t index) const final { return stamps_.at(index); }
  [[nodiscard]] Trajectory ground_truth() const final { return ground_truth_; }
  [[nodiscard]] Scan read(std::size_t index) final;

 protected:
  /// Files of a folder by extension; throws InputError where there are none.
  ScanFiles(const std::filesystem::path& path, const char* format,
            const std::filesystem::path& folder, const char* extension,
            const RecordingOptions& options);
  /// Files are chosen by the reader itself.
  ScanFiles(const std::filesystem::path& path, const char* format, const RecordingOptions& options);

  /// Decodes buffer_, the bytes of files_[index]; sets all of `scan` but its stamp, which is set,
  /// and returns the number of records seen.
  virtual std::size_t decode(std::size_t index, Scan& scan) = 0;

  /// The same for records in buffer_ that `table` describes; `request` without attributes, which
  /// are those that were asked for.
  std::size_t decode_table(std::size_t index, const PointTable& table, DecodeRequest request,
                           Scan& scan) const;

  /// Stamps from the files' names in `nanoseconds` units; throws InputError naming a file whose
  /// name is none.
  void take_stamps_from_names(Nanoseconds nanoseconds, const char* unit);
  /// Warns of files that are empty or whose length is no multiple of `record`: reading them throws.
  /// Throws InputError naming the first where most are, which says that the record is another. The
  /// last one is left out, with a warning, where enough is there without it.
  void check_lengths(std::size_t record, const char* fields);
  /// Calls `check` for the last file, and leaves that out, with its stamp, where it throws an
  /// InputError and there are more: a recording that was interrupted.
  template <typename F>
  void check_last(F&& check) {
    try {
      check(files_.size() - 1);
    } catch (const InputError& e) {
      if (files_.size() <= kEnough) throw;
      leave_out_last(e.what());
    }
  }
  /// Those of all files, of one that was left out at the end as well: what lists go by.
  [[nodiscard]] std::vector<Nanoseconds> all_stamps() const;
  /// The same of files_[index].
  void check_length(std::size_t index, std::size_t record, const char* fields) const;
  /// Records in buffer_; throws InputError naming the file and `fields` where its length does not
  /// fit.
  [[nodiscard]] std::size_t record_count(std::size_t index, std::size_t record,
                                         const char* fields) const;

  RecordingInfo info_;
  std::vector<std::filesystem::path> files_;
  std::vector<Nanoseconds> stamps_;
  Trajectory ground_truth_;
  std::vector<std::byte> buffer_;
  AttributeSet attributes_;  ///< asked for

 private:
  static constexpr std::size_t kEnough = 3;
  void leave_out_last(const std::string& why);
  std::optional<Nanoseconds> left_out_;
};

}  // namespace groundloop::recordings
