// The suites of data sets on simulated recordings written as each data set is laid out after
// downloading, small, with a part of its sequences: those are run, the others named.
#include <algorithm>

#include <gtest/gtest.h>

#include "apps/benchmark/benchmark.hpp"
#include "apps/benchmark/results.hpp"
#include "apps/benchmark/suite.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"
#include "frontend/simulation/layouts/layout_writer.hpp"
#include "frontend/simulation/simulation.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop::apps {
namespace {

namespace fs = std::filesystem;
using groundloop::testing::TemporaryFolder;

void write(const std::string& simulation, const std::string& layout, const fs::path& folder,
           const std::string& sensor = "Ouster") {
  write_layout(*open_simulation(simulation), layout, folder, sensor);
}

constexpr const char* kFirst = "sim:town?sensor=spin16&length=130&seed=61";
constexpr const char* kSecond = "sim:town?sensor=spin16&length=130&seed=61&route=2&change=1";

// Runs the first configuration of a built-in suite on what is in `data`.
Results run(const std::string& suite, const TemporaryFolder& folder, std::size_t recordings,
            std::size_t pairs) {
  BenchmarkRequest request;
  request.suite = suite;
  request.data = folder / "data";
  request.runner.groundloop = GROUNDLOOP_BINARY;
  request.runner.out = folder / ("out_" + suite);
  const BenchmarkSummary summary = run_benchmark(request, {});
  for (const StepOutcome& f : summary.failures) ADD_FAILURE() << f.name << ": " << f.why;
  Results results = read_results(request.runner.out / "results.json");
  const std::string configuration = read_suite(suite).configurations.front().name;
  const auto count = [&](const std::string& kind) {
    return static_cast<std::size_t>(
        std::count_if(results.results.begin(), results.results.end(), [&](const Result& r) {
          return r.kind == kind && r.configuration == configuration && r.detector.empty() &&
                 r.references == "truth";
        }));
  };
  EXPECT_EQ(count("recording"), recordings) << suite;
  EXPECT_EQ(count("pair"), pairs) << suite;
  for (const Result& r : results.results) {
    if (r.kind == "recording" && r.detector.empty()) {
      EXPECT_TRUE(r.figures.contains("ape")) << suite << " " << r.subject << ": no ground truth";
      EXPECT_LT(r.figures.at("ape"), 1.0) << suite << " " << r.subject;
    }
  }
  EXPECT_GT(summary.missing.size(), 0U);
  return results;
}

TEST(DatasetSuites, Kitti) {
  const TemporaryFolder folder;
  write(kFirst, "kitti", folder / "data" / "dataset");  // sequence 00
  const Results results = run("kitti", folder, 1, 0);
  EXPECT_NE(results.gaps.front().why.find("dataset/sequences/01"), std::string::npos);
}

TEST(DatasetSuites, Mulran) {
  const TemporaryFolder folder;
  write(kFirst, "mulran", folder / "data" / "KAIST01");
  write(kSecond, "mulran", folder / "data" / "KAIST03");
  const Results results = run("mulran", folder, 2, 1);
}

TEST(DatasetSuites, Helipr) {
  const TemporaryFolder folder;
  write(kFirst, "helipr", folder / "data" / "Bridge02", "Ouster");
  write(kSecond, "helipr", folder / "data" / "Bridge03", "Ouster");
  (void)run("helipr", folder, 2, 1);
}

TEST(DatasetSuites, Nclt) {
  const TemporaryFolder folder;
  const fs::path date = folder / "data" / "2012-01-08";
  write("sim:town?sensor=spin32&length=130&seed=61", "nclt", date);
  (void)run("nclt", folder, 1, 0);
}

TEST(DatasetSuites, NewerCollege) {
  const TemporaryFolder folder;
  const fs::path sequence = folder / "data" / "01_short_experiment";
  write(kFirst, "rosbag", sequence / "rosbag");
  fs::create_directories(sequence / "ground_truth");
  fs::copy_file(sequence / "rosbag" / "ground_truth.tum",
                sequence / "ground_truth" / "registered_poses.csv");
  (void)run("newer_college", folder, 1, 0);
}

TEST(DatasetSuites, Hilti) {
  const TemporaryFolder folder;
  const fs::path data = folder / "data";
  write(kFirst, "rosbag", folder / "written");
  fs::create_directories(data);
  const std::string name = "exp04_construction_upper_level";
  fs::copy_file(list_files(folder / "written", ".bag").at(0), data / (name + ".bag"));
  fs::copy_file(folder / "written" / "ground_truth.tum", data / (name + "_imu.txt"));
  write_text_atomically(data / "T_imu_lidar.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  (void)run("hilti", folder, 1, 0);
}

}  // namespace
}  // namespace groundloop::apps
