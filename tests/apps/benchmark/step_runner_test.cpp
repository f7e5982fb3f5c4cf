#include "apps/benchmark/step_runner.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "frontend/core/files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop::apps {
namespace {

using State = StepOutcome::State;

// Steps of a shell that write a letter to a log each time they are run, and leave a file.
class StepRunner : public ::testing::Test {
 protected:
  Step step(const std::string& name, const std::vector<std::string>& needs,
            const std::string& more = "") const {
    Step s;
    s.name = name;
    s.groundloop = false;
    s.result = folder_ / (name + ".txt");
    s.command = {"sh", "-c",
                 "printf " + name + " >> " + (folder_ / "order").string() + "; " + more +
                     " touch " + s.result.string()};
    s.needs = needs;
    s.memory_mb = 100;
    return s;
  }
  std::vector<StepOutcome> run(const std::vector<Step>& steps,
                               const std::vector<std::string>& only = {}) {
    StepRunnerOptions options;
    options.out = folder_.path();
    options.jobs = 2;
    options.memory_mb = memory_mb_;
    options.only = only;
    return run_steps(steps, options, {});
  }
  [[nodiscard]] std::string order() const { return read_text(folder_ / "order"); }

  groundloop::testing::TemporaryFolder folder_;
  int memory_mb_ = 150;  // one at a time
};

TEST_F(StepRunner, RunsWhatIsNeededFirstAndEachOnce) {
  const std::vector<Step> steps{step("a", {}), step("b", {"a"}), step("c", {"a", "b"})};
  for (int call = 0; call < 2; ++call) {
    const auto outcomes = run(steps);
    ASSERT_EQ(outcomes.size(), 3U);
    for (const StepOutcome& o : outcomes) EXPECT_EQ(o.state, State::done) << o.why;
  }
  EXPECT_EQ(order(), "abc");
}

TEST_F(StepRunner, RunsAgainWhatChangedAndWhatNeedsIt) {
  (void)run({step("a", {}), step("b", {"a"}), step("x", {})});
  (void)run({step("a", {}, "true;"), step("b", {"a"}), step("x", {})});
  EXPECT_EQ(order(), "abxab");
}

TEST_F(StepRunner, AFailureBlocksOnlyWhatNeedsItAndIsTriedAgain) {
  const std::vector<Step> steps{step("a", {}, "echo broken >&2; exit 3;"), step("b", {"a"}),
                                step("x", {})};
  auto outcomes = run(steps);
  EXPECT_EQ(outcomes[0].state, State::failed);
  EXPECT_EQ(outcomes[0].why, "broken");
  EXPECT_EQ(outcomes[1].state, State::blocked);
  EXPECT_EQ(outcomes[2].state, State::done);
  (void)run(steps);
  EXPECT_EQ(order(), "axa");
}

TEST_F(StepRunner, AStepThatLeavesNothingHasFailed) {
  Step s = step("a", {});
  s.result = folder_ / "never";
  EXPECT_EQ(run({s})[0].state, State::failed);
}

TEST_F(StepRunner, KeepsStandardOutputOfAStepThatSucceeds) {
  Step s = step("a", {}, "echo result;");
  s.standard_output = s.result = folder_ / "out" / "a.json";
  s.command = {"sh", "-c", "echo result; echo log >&2"};
  EXPECT_EQ(run({s})[0].state, State::done);
  EXPECT_EQ(read_text(folder_ / "out" / "a.json"), "result\n");
  EXPECT_EQ(read_text(folder_ / "logs" / "a.log"), "log\n");
}

TEST_F(StepRunner, RunsOnlyWhatIsAskedForAndWhatThatNeeds) {
  (void)run({step("a", {}), step("b", {"a"}), step("x", {})}, {"b"});
  EXPECT_EQ(order(), "ab");
}

TEST_F(StepRunner, RunsOneStepAloneOnceItsNeedsAreDone) {
  const std::vector<Step> steps{step("a", {}), step("b", {"a"})};
  StepRunnerOptions options;
  options.out = folder_.path();
  options.step = "b";
  EXPECT_EQ(run_steps(steps, options, {}).at(0).state, State::blocked);
  options.step = "a";
  EXPECT_EQ(run_steps(steps, options, {}).at(0).state, State::done);
  options.step = "b";
  EXPECT_EQ(run_steps(steps, options, {}).at(0).state, State::done);
  EXPECT_EQ(order(), "ab");
}

TEST_F(StepRunner, RunsSeveralAtATimeAsMemoryAllows) {
  // Each waits for the other to have begun.
  const auto wait_for = [&](const std::string& other) {
    return "until [ -e " + (folder_ / other).string() + " ]; do sleep 0.01; done;";
  };
  memory_mb_ = 250;
  const std::vector<Step> steps{
      step("a", {}, "touch " + (folder_ / "a").string() + "; " + wait_for("b")),
      step("b", {}, "touch " + (folder_ / "b").string() + "; " + wait_for("a"))};
  for (const StepOutcome& o : run(steps)) EXPECT_EQ(o.state, State::done);
}

TEST_F(StepRunner, AProgramThatIsNotThereIsNamed) {
  Step s = step("a", {});
  s.command = {"no-such-program"};
  const auto outcomes = run({s});
  EXPECT_EQ(outcomes[0].state, State::failed);
  EXPECT_NE(outcomes[0].why.find("no-such-program"), std::string::npos);
}

}  // namespace
}  // namespace groundloop::apps
