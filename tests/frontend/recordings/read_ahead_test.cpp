#include "frontend/recordings/read_ahead.hpp"

#include <atomic>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "frontend/core/unreadable_file.hpp"

namespace groundloop {
namespace {

// Scans whose only point names their number; scan `bad` cannot be read.
class Counting final : public Recording {
 public:
  explicit Counting(std::size_t size, std::size_t bad = static_cast<std::size_t>(-1))
      : size_(size), bad_(bad) {}
  const RecordingInfo& info() const override { return info_; }
  std::size_t size() const override { return size_; }
  Nanoseconds stamp(std::size_t index) const override { return static_cast<Nanoseconds>(index); }
  Scan read(std::size_t index) override {
    if (index == bad_) throw InputError("scan is bad");
    ++reads;
    Scan scan;
    scan.stamp = stamp(index);
    scan.points.emplace_back(static_cast<float>(index), 0.0F, 0.0F);
    return scan;
  }
  std::atomic<std::size_t> reads = 0;

 private:
  RecordingInfo info_;
  std::size_t size_, bad_;
};

TEST(ReadAhead, HandsOutEveryScanInOrder) {
  Counting recording(100);
  ReadAhead ahead(recording, 10, 50);
  for (Nanoseconds i = 10; i < 60; ++i) {
    const auto scan = ahead.next();
    ASSERT_TRUE(scan);
    EXPECT_EQ(scan->stamp, i);
  }
  EXPECT_FALSE(ahead.next());
  EXPECT_FALSE(ahead.next());
}

TEST(ReadAhead, StopsAtTheEndOfTheRecording) {
  Counting recording(3);
  ReadAhead ahead(recording, 1, static_cast<std::size_t>(-1));
  EXPECT_TRUE(ahead.next());
  EXPECT_TRUE(ahead.next());
  EXPECT_FALSE(ahead.next());
  ReadAhead beyond(recording, 7, 2);
  EXPECT_FALSE(beyond.next());
}

TEST(ReadAhead, CarriesAnErrorToItsPlaceInTheOrderAndGoesOn) {
  Counting recording(10, 2);
  ReadAhead ahead(recording, 0, 10);
  EXPECT_TRUE(ahead.next());
  EXPECT_TRUE(ahead.next());
  EXPECT_THROW((void)ahead.next(), InputError);
  for (Nanoseconds i = 3; i < 10; ++i) {
    const auto scan = ahead.next();
    ASSERT_TRUE(scan);
    EXPECT_EQ(scan->stamp, i);
  }
  EXPECT_FALSE(ahead.next());
}

TEST(ReadAhead, EndsWhereAFileIsNotHandedOut) {
  class Gone final : public Recording {
   public:
    const RecordingInfo& info() const override { return info_; }
    std::size_t size() const override { return 10; }
    Nanoseconds stamp(std::size_t index) const override { return static_cast<Nanoseconds>(index); }
    Scan read(std::size_t) override { throw UnreadableFile("the disk is gone"); }

   private:
    RecordingInfo info_;
  };
  Gone recording;
  ReadAhead ahead(recording, 0, 10);
  EXPECT_THROW((void)ahead.next(), UnreadableFile);
  EXPECT_FALSE(ahead.next());
}

TEST(ReadAhead, HoldsNoMoreThanItsDepth) {
  Counting recording(1000);
  {
    ReadAhead ahead(recording, 0, 1000, 3);
    (void)ahead.next();
    // However long the thread runs, it reads the one taken, three that wait and one in hand.
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_LE(recording.reads, 5U);
  }
  EXPECT_LE(recording.reads, 5U);  // and the destructor ends it
}

}  // namespace
}  // namespace groundloop
