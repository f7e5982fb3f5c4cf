#include "frontend/simulation/simulation.hpp"

#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/core/parallel.hpp"

namespace groundloop {
namespace {

const char* const drive = "sim:town?seed=3&length=300&sensor=spin16";

TEST(Simulation, ScansDoNotDependOnThreadsOrOrderOfReading) {
  const auto forward = open_simulation(drive), backward = open_simulation(drive);
  const std::size_t indices[] = {0, 70, 140};
  std::vector<Scan> scans;
  for (const std::size_t i : indices) scans.push_back(forward->read(i));
  set_thread_count(1);
  for (std::size_t k = 3; k-- > 0;) {
    const Scan again = backward->read(indices[k]);
    EXPECT_EQ(again.stamp, scans[k].stamp);
    EXPECT_EQ(again.points, scans[k].points);
    EXPECT_EQ(again.times, scans[k].times);
  }
  set_thread_count(0);
}

TEST(Simulation, PointTimesLieWithinTheScan) {
  const Scan scan = open_simulation(drive)->read(5);
  ASSERT_EQ(scan.times.size(), scan.points.size());
  for (const float t : scan.times) {
    EXPECT_GE(t, 0.0F);
    EXPECT_LT(t, 0.1F);
  }
  EXPECT_TRUE(std::is_sorted(scan.times.begin(), scan.times.end()));
}

TEST(Simulation, GroundTruthIsThePoseAtEachInstant) {
  const auto recording = open_simulation(drive);
  const Trajectory start = recording->ground_truth();
  const Trajectory end = recording->ground_truth_at(ScanInstant::end);
  ASSERT_EQ(start.size(), recording->size());
  for (std::size_t i = 0; i + 1 < start.size(); ++i) {
    EXPECT_EQ(start[i].stamp, recording->stamp(i));
    EXPECT_EQ(end[i].stamp, start[i + 1].stamp);
    EXPECT_EQ(end[i].pose.translation, start[i + 1].pose.translation);
  }
}

TEST(Simulation, AScanBeyondTheEndIsRefused) {
  const auto recording = open_simulation(drive);
  EXPECT_THROW((void)recording->read(recording->size()), InputError);
}

}  // namespace
}  // namespace groundloop
