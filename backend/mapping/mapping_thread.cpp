#include "backend/mapping/mapping_thread.hpp"

#include "frontend/core/clock.hpp"

namespace groundloop {

MappingThread::MappingThread(LocalMapBuilder& builder, ClosureFinder& finder, ScanKeeper& keeper)
    : builder_(builder), finder_(finder), keeper_(keeper), thread_([this] { run(); }) {}

MappingThread::~MappingThread() { stop(); }

void MappingThread::add(Points points, std::vector<float> intensity, const Pose& T_world_scan,
                        bool apart) {
  {
    const std::lock_guard lock(mutex_);
    ++pending_;
  }
  if (!queue_.push({std::move(points), std::move(intensity), T_world_scan, apart})) finish();
}

void MappingThread::drain() {
  std::unique_lock lock(mutex_);
  idle_.wait(lock, [&] { return pending_ == 0 || error_; });
  if (error_) std::rethrow_exception(error_);
}

void MappingThread::finish() {
  stop();
  if (error_) std::rethrow_exception(error_);
}

void MappingThread::stop() {
  queue_.close();
  if (thread_.joinable()) thread_.join();
}

void MappingThread::run() {
  try {
    while (std::optional<Item> item = queue_.pop()) {
      auto start = Clock::now();
      if (item->apart) {
        if (const std::optional<LocalMap> before = builder_.finish()) finder_.add(*before);
        start = Clock::now();
      }
      const std::optional<LocalMap> map = builder_.add(item->points, item->T_world_scan);
      building_seconds_ += seconds_since(start);
      start = Clock::now();
      keeper_.add(item->points, item->intensity, item->T_world_scan);
      keeping_seconds_ += seconds_since(start);
      if (map) finder_.add(*map);
      const std::lock_guard lock(mutex_);
      --pending_;
      idle_.notify_all();
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    error_ = std::current_exception();
    idle_.notify_all();
    queue_.close();
  }
}

}  // namespace groundloop
