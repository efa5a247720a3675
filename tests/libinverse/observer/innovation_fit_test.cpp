#include "libinverse/observer/innovation_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/libinverse/observer/bowed_record.hpp"

namespace modcal::observer::innovation_fit_test {
namespace {

struct Case {
  BowedRecord bowed = light_record(0.05, 0.02);
  ObservedRecord record = observe_record(bowed.basis, bowed.scene.bow.position, bowed.rate,
                                         bowed.left.samples, bowed.right.samples);

  ObserverParameters start() const {
    ObserverParameters start;
    start.sliding = {.dynamic_force = 0.2, .force_drop = 0.2, .decay = 5.0};
    start.bow_velocity = 0.1;
    start.stiffness = 1e5;
    start.contact = record.contact;
    std::copy_n(record.offset, 2, start.offset);
    return start;
  }
  // A fit from the paper's contact on, by steps of a part of the usual.
  FitOutcome fit(const FitLimits& limits, double part = 1.0,
                 Innovations* at_start = nullptr) const {
    const double deviation[2] = {1e-3, 1e-3};
    const ObserverRuns runs(record, {0.02}, {4, 16});
    std::vector<FreeParameter> free = basic_parameters(0.4, deviation);
    for (FreeParameter& parameter : free) parameter.step *= part, parameter.prior /= part;
    const ParameterSpace space(start(), free);
    if (at_start) *at_start = runs.innovations(start(), {0}, record.samples());
    return fit_innovations(runs, space, {0}, limits);
  }
};

// Weights are 1 but of bursts, whose answer is six times that of the median: by steps so small that
// no fit gets anywhere the cost is nearly the sum of Huber's, no more and, of half of the samples
// at the least, no less.
TEST(InnovationFit, WeighsEverySampleButBursts) {
  const Case the;
  Innovations start;
  const double small = the.fit({.iterations = 1}, 1e-3, &start).cost;
  double sum = 0.0;
  for (const auto& scaled : start.scaled) {
    for (const double x : scaled) {
      const double size = std::abs(x);
      sum += size <= 3.0 ? 0.5 * x * x : 3.0 * (size - 1.5);
    }
  }
  EXPECT_LE(small, sum);
  EXPECT_GT(small, 0.5 * sum);
  EXPECT_LT(the.fit({.iterations = 1}).cost, small);
}

TEST(InnovationFit, SeesTheStatedSamplesAlone) {
  Case the;
  const FitLimits half{.iterations = 2, .samples = the.record.samples() / 2};
  const FitOutcome clean = the.fit(half);
  for (auto& reaction : the.record.reaction) {
    std::fill(reaction.begin() + static_cast<std::ptrdiff_t>(half.samples), reaction.end(), 0.1);
  }
  EXPECT_EQ(the.fit(half).x, clean.x);
  EXPECT_GT(clean.iterations, 0u);
}

// Two gains of one size tie in every block: the first one listed stays.
TEST(SearchGains, TakesTheFirstOfEqualOnes) {
  const Case the;
  const ObserverRuns runs(the.record, {0.02, 0.02}, {4, 16});
  const std::size_t both[] = {0, 1};
  const GainSchedule path = search_gains(runs, the.start(), both);
  EXPECT_GT(path.size(), 3u);
  for (const std::size_t gain : path) EXPECT_EQ(gain, 0u);
}

}  // namespace
}  // namespace modcal::observer::innovation_fit_test
