// Every fuzz target on the inputs it starts from and on changes of them that are always the same:
// the short run that is part of the tests. tests/fuzz/fuzz.sh is the long one.
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include "frontend/core/error.hpp"
#include "tests/fuzz/allocation_watch.hpp"
#include "tests/fuzz/corpus.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/mutation.hpp"

namespace groundloop::fuzz {
namespace {

// A chunk of a bag may be of 64 MiB whatever its stored length; nothing else comes near.
constexpr std::size_t kLargestAllocation = 80U << 20U;

Input bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

// Changes of inputs, in all, by how long one takes.
std::uint64_t changes_of(const std::string& target) {
  for (const char* slow : {"session_commands", "optimize"}) {
    if (target == slow) return 60;
  }
  for (const char* larger : {"checkpoint", "session", "folder", "front_end", "helipr", "kitti",
                             "kitti_raw", "mulran", "nclt", "nuscenes", "pcap", "rosbag", "rosbag2",
                             "mcap", "trajectory", "truth_conventions"}) {
    if (target == larger) return 400;
  }
  return 3000;
}

class Replay : public ::testing::TestWithParam<Target> {
 protected:
  static void SetUpTestSuite() { set_up(); }

  // What a command prints about the input it refuses is not wanted here.
  void run_quietly(const std::string& name, const std::string& content) {
    (void)take_largest_allocation();
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    std::string other_error;
    try {
      run(GetParam(), bytes_of(content));
    } catch (const std::exception& e) {
      other_error = e.what();
    }
    (void)::testing::internal::GetCapturedStdout();
    const std::string text = ::testing::internal::GetCapturedStderr();
    EXPECT_EQ(other_error, "") << name << "\n" << text;
    EXPECT_LE(take_largest_allocation(), kLargestAllocation) << name;
  }
};

TEST_P(Replay, KeptInputsAreAnsweredAndGoodOnesAccepted) {
  const std::vector<KeptInput> inputs = corpus_of(GetParam().name);
  ASSERT_FALSE(inputs.empty()) << "give the target an input to start from";
  for (const KeptInput& input : inputs) {
    run_quietly(input.name, input.content);
    if (!input.accepted) continue;
    try {
      GetParam().run(bytes_of(input.content));
    } catch (const InputError& e) {
      ADD_FAILURE() << input.name << " is refused: " << e.what();
    }
  }
}

TEST_P(Replay, ChangedInputsAreAnsweredOrRefused) {
  const std::vector<KeptInput> inputs = corpus_of(GetParam().name);
  ASSERT_FALSE(inputs.empty());
  for (std::uint64_t seed = 0; seed < changes_of(GetParam().name) && !HasFailure(); ++seed) {
    const KeptInput& input = inputs[seed % inputs.size()];
    run_quietly(input.name + " change " + std::to_string(seed), mutate(input.content, seed));
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, Replay, ::testing::ValuesIn(targets()),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace

// How a target is named in messages of the tests.
static void PrintTo(const Target& target, std::ostream* out) { *out << target.name; }

}  // namespace groundloop::fuzz
