#include "frontend/recordings/read_ahead.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "frontend/core/unreadable_file.hpp"

namespace groundloop {

ReadAhead::ReadAhead(Recording& recording, std::size_t first, std::size_t count, std::size_t depth)
    : recording_(recording), depth_(std::max<std::size_t>(depth, 1)) {
  first = std::min(first, recording.size());
  const std::size_t end = first + std::min(count, recording.size() - first);
  thread_ = std::thread([this, first, end] { run(first, end); });
}

ReadAhead::~ReadAhead() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::optional<Scan> ReadAhead::next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return !scans_.empty() || finished_; });
  if (scans_.empty()) return std::nullopt;
  Item item = std::move(scans_.front());
  scans_.pop_front();
  lock.unlock();
  changed_.notify_all();
  if (item.error) std::rethrow_exception(item.error);
  return std::move(item.scan);
}

double ReadAhead::seconds_reading() const {
  const std::lock_guard lock(mutex_);
  return seconds_;
}

void ReadAhead::run(std::size_t first, std::size_t end) {
  using Clock = std::chrono::steady_clock;
  bool over = false;
  for (std::size_t i = first; i < end && !over; ++i) {
    const Clock::time_point begin = Clock::now();
    Item item;
    try {
      item.scan = recording_.read(i);
    } catch (const UnreadableFile&) {
      item.error = std::current_exception();
      over = true;
    } catch (const InputError&) {
      item.error = std::current_exception();
    } catch (...) {
      item.error = std::current_exception();
      over = true;
    }
    std::unique_lock lock(mutex_);
    seconds_ += std::chrono::duration<double>(Clock::now() - begin).count();
    changed_.wait(lock, [&] { return scans_.size() < depth_ || stop_; });
    if (stop_) return;
    scans_.push_back(std::move(item));
    lock.unlock();
    changed_.notify_all();
  }
  const std::lock_guard lock(mutex_);
  finished_ = true;
  changed_.notify_all();
}

}  // namespace groundloop
