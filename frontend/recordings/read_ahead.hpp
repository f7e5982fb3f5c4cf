// Scans read ahead in the background: a thread reads, the caller takes them in order, and at most
// `depth` scans wait in memory. An error of reading reaches the caller where its scan would have.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "frontend/recordings/recording.hpp"

namespace groundloop {

class ReadAhead {
 public:
  /// Reads scans [first, first + count) of `recording`, which must outlive this object and must
  /// not be read by anyone else meanwhile. A count beyond the end stops at the end.
  ReadAhead(Recording& recording, std::size_t first, std::size_t count, std::size_t depth = 4);
  ~ReadAhead();
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  /// The next scan; nothing after the last one. Rethrows what reading it threw: after InputError
  /// the scan after it follows, after UnreadableFile and all else nothing.
  [[nodiscard]] std::optional<Scan> next();

  /// Seconds the background thread spent reading so far.
  [[nodiscard]] double seconds_reading() const;

 private:
  void run(std::size_t first, std::size_t end);

  Recording& recording_;
  const std::size_t depth_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  struct Item {
    Scan scan;
    std::exception_ptr error;  // in the scan's place
  };
  std::deque<Item> scans_;
  double seconds_ = 0.0;
  bool finished_ = false;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace groundloop
