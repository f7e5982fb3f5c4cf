// The thread that turns registered scans into local maps and closures, and keeps them, while
// odometry goes on.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>

#include "backend/mapping/closure_finder.hpp"
#include "backend/mapping/scan_keeper.hpp"
#include "frontend/core/bounded_queue.hpp"
#include "frontend/local_maps/local_map_builder.hpp"

namespace groundloop {

class MappingThread {
 public:
  MappingThread(LocalMapBuilder& builder, ClosureFinder& finder, ScanKeeper& keeper);
  /// Waits until all scans that were added are mapped; errors are dropped.
  ~MappingThread();
  MappingThread(const MappingThread&) = delete;
  MappingThread& operator=(const MappingThread&) = delete;

  /// Hands a scan over; waits while the thread is too far behind. Throws what the thread threw.
  /// `intensity` has a value a point, or none. Where the scan is `apart` from the one before, the
  /// map of that one ends.
  void add(Points points, std::vector<float> intensity, const Pose& T_world_scan, bool apart);
  /// Waits until all scans that were added are mapped; more may follow. Throws what the thread
  /// threw, every time once it has: local maps are missing from then on.
  void drain();
  /// Waits until all scans are mapped; none follow. Throws what the thread threw.
  void finish();
  /// Busy seconds of building local maps.
  [[nodiscard]] double building_seconds() const { return building_seconds_; }
  /// Busy seconds of keeping scans.
  [[nodiscard]] double keeping_seconds() const { return keeping_seconds_; }

 private:
  struct Item {
    Points points;
    std::vector<float> intensity;
    Pose T_world_scan;
    bool apart;
  };
  void run();
  void stop();

  LocalMapBuilder& builder_;
  ClosureFinder& finder_;
  ScanKeeper& keeper_;
  BoundedQueue<Item> queue_{16};
  std::mutex mutex_;
  std::condition_variable idle_;
  std::size_t pending_ = 0;  // added and not yet mapped
  std::exception_ptr error_;
  double building_seconds_ = 0.0;
  double keeping_seconds_ = 0.0;
  std::thread thread_;
};

}  // namespace groundloop
