#include <gtest/gtest.h>

#include "libinverse/invert.hpp"
#include "libsim/base/error.hpp"

namespace modcal::inversion_options_test {
namespace {

TEST(InversionOptions, AreJointUnlessToldOtherwise) {
  const InversionOptions options;
  EXPECT_EQ(options.estimator.selected(), "joint");
  EXPECT_EQ(options.regularizer.selected(), "water_level");  // the paper's, of one side
  EXPECT_EQ(options.parameter_choice.selected(), "minimal_product");
}

TEST(InversionOptions, MakeTheMethodTheyName) {
  InversionOptions options;
  EXPECT_TRUE(InversionRecipe(options).method().regularizer.has_parameter());
  options.regularizer.select("none");
  const InversionRecipe recipe(options);
  const InversionMethod method = recipe.method({.force = false, .velocity = true}, 0.25);
  EXPECT_FALSE(method.regularizer.has_parameter());
  EXPECT_FALSE(method.outputs.force);
  EXPECT_TRUE(method.outputs.velocity);
  EXPECT_EQ(method.noise_rms, 0.25);
}

TEST(InversionOptions, RefuseAnUnknownEstimator) {
  InversionOptions options;
  EXPECT_THROW(options.estimator.select("psychic"), InvalidInput);
}

}  // namespace
}  // namespace modcal::inversion_options_test
