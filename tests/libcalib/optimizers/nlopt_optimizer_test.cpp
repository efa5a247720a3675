#include "libcalib/optimizers/nlopt_optimizer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlopt.h>

#include "libsim/base/error.hpp"
#include "tests/libcalib/test_functions.hpp"

namespace modcal::nlopt_optimizer_test {
namespace {

using testing::HasSubstr;

NloptOptimizer nlopt_with(std::string_view algorithm, std::int64_t seed = 1) {
  return NloptOptimizer({.algorithm = std::string(algorithm), .seed = seed});
}

TEST(NloptOptimizer, OneVariableIsSolvedOrRefusedInWords) {
  const ValueOnly function(1, [](std::span<const double> x) { return x[0] * x[0]; });
  const std::vector<Variable> line = {{"x", "1", 0.5, -1.0, 2.0, 1.0}};
  for (const auto algorithm : NloptOptimizer::algorithms()) {
    try {
      const auto result = nlopt_with(algorithm).minimize(function, line, {.evaluations = 2000});
      EXPECT_NEAR(result.x[0], 0.0, 1e-2) << algorithm;
    } catch (const InvalidInput& refusal) {
      EXPECT_THAT(refusal.what(), HasSubstr("refuses 1 variables")) << algorithm;
      EXPECT_TRUE(algorithm.starts_with("LN_NEWUOA")) << algorithm;
    }
  }
}

TEST(NloptOptimizer, SeedsDecideWhatRandomAlgorithmsDo) {
  const auto run = [](std::int64_t seed) {
    return nlopt_with("GN_CRS2_LM", seed).minimize(Branin(), branin_box(), {.evaluations = 200}).x;
  };
  EXPECT_EQ(run(3), run(3));
  EXPECT_NE(run(3), run(4));
}

TEST(NloptOptimizer, EveryAlgorithmNloptListsIsUsedOrRefusedWithAReason) {
  for (const NloptAlgorithm& row : NloptOptimizer::listed()) {
    if (row.use != NloptUse::kRefused) {
      EXPECT_NO_THROW(nlopt_with(row.name)) << row.name;
      continue;
    }
    try {
      nlopt_with(row.name);
      FAIL() << row.name;
    } catch (const InvalidInput& refusal) {
      EXPECT_THAT(refusal.what(), HasSubstr(std::string(row.refusal)));
    }
  }
  EXPECT_EQ(NloptOptimizer::listed().size(), static_cast<std::size_t>(NLOPT_NUM_ALGORITHMS));
  EXPECT_THROW(nlopt_with("BOBYQA"), InvalidInput);
  EXPECT_THROW(nlopt_with(""), InvalidInput);
}

TEST(NloptOptimizer, LocalAlgorithmsGoWithMlslAlone) {
  const NloptOptimizer mlsl({.algorithm = "GN_MLSL", .local_algorithm = "LN_COBYLA"});
  EXPECT_NEAR(mlsl.minimize(Branin(), branin_box(), {.evaluations = 2000}).value, Branin::kMinimum,
              1e-6);
  using Options = NloptOptimizer::Options;
  for (const Options& wrong : {Options{.algorithm = "LN_BOBYQA", .local_algorithm = "LN_COBYLA"},
                               Options{.algorithm = "GN_MLSL", .local_algorithm = "LD_LBFGS"},
                               Options{.algorithm = "GN_MLSL", .local_algorithm = "GN_DIRECT"}}) {
    EXPECT_THROW(NloptOptimizer{wrong}, InvalidInput);
  }
}

}  // namespace
}  // namespace modcal::nlopt_optimizer_test
