#include <gtest/gtest.h>

#include "libcalib/objectives/force_difference.hpp"
#include "libcalib/optimizers/nlopt_optimizer.hpp"
#include "libcalib/optimizers/systematic_search.hpp"
#include "libinverse/spectral/choices/rules.hpp"
#include "libinverse/spectral/one_sided/one_sided_inversion.hpp"
#include "libinverse/spectral/regularizers/regularizers.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/calibration_case.hpp"
#include "tests/libcalib/slope_check.hpp"

namespace modcal::contact_location_test {
namespace {

using Names = std::vector<std::string>;

// The waveforms of the inversion library, compared sample by sample over the whole band.
TEST(ContactLocation, IsTheRelativeDifferenceOfTheIdentifiedWaveforms) {
  const std::size_t samples = 1601;  // odd: no Nyquist bin
  const ModelPoint truth = paper_truth(12);
  const CalibrationData data = exact_data(truth, samples, 6400.0, 196.0);
  ContactLocation::Options options;
  options.inversion.lowest = 0.0;
  options.inversion.highest = 3200.0;
  options.inversion.parameter = 0.2;
  options.inversion.common_filter = false;
  const ParameterSet parameters(truth, Names{"x_c"});
  const auto function = ContactLocation(options).bind(data, parameters);

  const double contact = 0.0315;
  GivenParameter::Options fixed;
  fixed.value = 0.2;
  const GivenParameter choice(fixed);
  const Tikhonov tikhonov(Tikhonov::Options{});
  std::array<std::vector<double>, 2> force;
  for (std::size_t r = 0; r < 2; ++r) {
    const OneSidedInversion inversion(truth.basis, contact, static_cast<End>(r), samples, 6400.0);
    force[r] =
        inversion.invert(RealFft(samples).inverse(data.reactions[r]), {tikhonov, choice}).force;
  }
  double difference = 0.0, power = 0.0;
  // The last bin, at K/2 − ½, lies in the band up to 3200 Hz but is left out like a Nyquist bin.
  for (std::size_t j = 0; j < samples; ++j) {
    difference += std::pow(force[0][j] - force[1][j], 2);
    power += 0.5 * (std::pow(force[0][j], 2) + std::pow(force[1][j], 2));
  }
  const double expected = std::sqrt(difference / power);
  const double value = function->value(std::vector<double>{contact});
  // One bin of 800, at the end of the band where |H| and with it the filtered force are small.
  EXPECT_NEAR(value, expected, 1e-3 * expected);
  EXPECT_LT(function->value(parameters.start()), value);
}

TEST(ContactLocation, GradientIsThatOfTheValue) {
  const CalibrationData data = exact_data(paper_truth(12), 3200, 6400.0, 196.0);
  const ModelPoint initial = with_frequency_errors(paper_truth(12), 0.01, 2);
  const ParameterSet parameters(initial, Names{"x_c", "f_4", "f0", "B"});
  const auto function = ContactLocation(ContactLocation::Options{}).bind(data, parameters);
  expect_slopes_match(*function, parameters.variables(), parameters.start(), 1e-5, 1e-5);
}

TEST(ContactLocation, FindsTheBowOnTheSimulatedString) {
  const CalibrationData data = bowed_data(0.5, 0.0, 4e-6);
  ModelPoint initial = paper_truth(50);
  initial.contact = 0.0315;
  const ParameterSet parameters(initial, Names{"x_c"}, {.contact = 4e-3});
  const auto function = ContactLocation(ContactLocation::Options{}).bind(data, parameters);
  const auto variables = parameters.variables();
  const auto scanned = Grid({.points = 81}).minimize(*function, variables, {});
  // The grid is 0.1 mm wide; the record is truncated, which moves the minimum by less than that.
  EXPECT_NEAR(scanned.x[0], 0.03, 1.01e-4);
  std::vector<Variable> near = variables;
  near[0].initial = scanned.x[0];
  NloptOptimizer::Options local;
  local.algorithm = "LN_NELDERMEAD";
  local.initial_step = 0.01;
  const auto refined = NloptOptimizer(local).minimize(*function, near, {});
  EXPECT_LE(refined.value, scanned.value);
  EXPECT_NEAR(refined.x[0], 0.03, 1e-4);
}

TEST(ContactLocation, NeedsTheContactToBeFreeAndBothReactions) {
  CalibrationData data = exact_data(paper_truth(12), 3200, 6400.0, 196.0);
  const ContactLocation objective(ContactLocation::Options{});
  EXPECT_THROW(objective.bind(data, ParameterSet(paper_truth(12), Names{"f_1"})), InvalidInput);
  data.reactions[0].clear();
  EXPECT_THROW(objective.bind(data, ParameterSet(paper_truth(12), Names{"x_c"})), InvalidInput);
}

}  // namespace
}  // namespace modcal::contact_location_test
