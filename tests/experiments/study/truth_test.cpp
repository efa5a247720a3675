#include <gtest/gtest.h>

#include <array>

#include "experiments/study/observation.hpp"
#include "experiments/study/study.hpp"
#include "libsim/base/task_loop.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::truth_test {
namespace {

TruthOptions short_truth() {
  TruthOptions options;
  options.scene = paper_scene();
  options.scene.duration = 0.05;
  return options;
}

TEST(TruthCache, SimulatesADistinctSceneOnceForAllThreads) {
  TruthCache cache;
  std::array<std::shared_ptr<const Truth>, 16> truths;
  for_each_task(truths.size(), [&](std::size_t i) {
    TruthOptions options = short_truth();
    options.scene.bow.normal_force = i % 2 == 0 ? 1.0 : 1.1;
    truths[i] = cache.get(options, 51200.0, {.force = true});
  });
  EXPECT_EQ(cache.simulated(), 2u);
  EXPECT_EQ(truths[0], truths[14]);
  EXPECT_NE(truths[0], truths[1]);
  EXPECT_EQ(truths[0]->simulation.force.size(), 2560u);
  EXPECT_TRUE(truths[0]->simulation.velocity.samples.empty());
}

TEST(TruthCache, TellsEveryWaiterWhyASceneCannotBeSimulated) {
  TruthCache cache;
  TruthOptions options = short_truth();
  options.scene.bow.position = 1.0;
  EXPECT_THROW(cache.get(options, 51200.0, {}), InvalidInput);
  EXPECT_THROW(cache.get(options, 51200.0, {}), InvalidInput);
}

}  // namespace
}  // namespace modcal::truth_test
