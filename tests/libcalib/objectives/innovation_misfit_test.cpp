#include "libcalib/objectives/innovation_misfit.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "libsim/base/error.hpp"
#include "tests/libinverse/model_based/bowed_record.hpp"

namespace modcal {
namespace {

using Names = std::vector<std::string>;

struct Case {
  BowedRecord record = bowed_record(0.08, 0.02);
  CalibrationData data =
      CalibrationData::of_records(record.left.samples, record.right.samples, kRecordRate);
  ModelPoint truth{record.basis, record.scene.bow.position};
};

const Case& the_case() {
  static const Case value;
  return value;
}

TEST(InnovationMisfit, IsNearOneAtTheTruthAndRisesAwayFromIt) {
  const Case& given = the_case();
  const ParameterSet parameters(given.truth, Names{"x_c", "f0"});
  const auto function = InnovationMisfit(InnovationMisfit::Options{}).bind(given.data, parameters);
  const auto x = parameters.start();
  const auto samples = static_cast<double>(given.data.samples);
  const double truth = function->value(x) / samples;
  // White innovations give 1 ± 0.016; one gain for the whole record lets some of the force's noise
  // through that it allows for.
  EXPECT_GT(truth, 0.95);
  EXPECT_LT(truth, 1.35);
  for (const double shift : {-1e-4, 1e-4}) {
    EXPECT_GT(function->value(std::vector<double>{x[0] + shift, x[1]}) / samples, 1.5 * truth);
  }
  for (const double share : {0.999, 1.001}) {
    EXPECT_GT(function->value(std::vector<double>{x[0], x[1] * share}) / samples, 1.5 * truth);
  }
}

TEST(InnovationMisfit, HasItsValueAsResiduals) {
  const Case& given = the_case();
  const ParameterSet parameters(given.truth, Names{"x_c"});
  const auto function = InnovationMisfit({.iterations = 0}).bind(given.data, parameters);
  EXPECT_TRUE(function->capabilities().sum_of_squares());
  EXPECT_FALSE(function->capabilities().gradient);
  std::vector<double> r(function->residual_count());
  double value = 0.0;
  function->evaluate(parameters.start(), {.value = &value, .residuals = r.data()});
  EXPECT_EQ(r.size(), 2 * given.data.samples);
  // Sums of 8192 terms in another order.
  EXPECT_NEAR(0.5 * std::inner_product(r.begin(), r.end(), r.begin(), 0.0), value, 1e-11 * value);
  EXPECT_EQ(function->value(parameters.start()), value);
}

TEST(InnovationMisfit, RefusesWhatItCannotPredict) {
  EXPECT_THROW(InnovationMisfit({.substeps = 0}), InvalidInput);
  EXPECT_THROW(InnovationMisfit({.force_noise = 0.0}), InvalidInput);
  Case given = the_case();
  given.data.reactions[0].clear();
  const ParameterSet parameters(given.truth, Names{"x_c"});
  EXPECT_THROW(InnovationMisfit(InnovationMisfit::Options{}).bind(given.data, parameters),
               InvalidInput);
}

}  // namespace
}  // namespace modcal
