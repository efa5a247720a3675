// The curve of a parameter rule against one inversion a parameter.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>

#include "libinverse/spectral/choices/rules.hpp"
#include "libinverse/spectral/one_sided/one_sided_inversion.hpp"
#include "tests/libinverse/safe_problem.hpp"

namespace modcal::inversion_curve_test {
namespace {

constexpr double kRate = 51200.0;

// The curve against one inversion in the time domain per parameter.
class BruteForce : public testing::TestWithParam<std::tuple<std::string, std::size_t>> {};
INSTANTIATE_TEST_SUITE_P(Curve, BruteForce,
                         testing::Combine(testing::Values("water_level", "water_level_clip",
                                                          "tikhonov"),
                                          testing::Values(250, 257)));

TEST_P(BruteForce, FindsTheNormsOfTheCurve) {
  const auto& [name, samples] = GetParam();
  const auto regularizer = Choice<Regularizer>(name).make();
  const SafeProblem safe(samples);
  const OneSidedInversion inversion(safe.transfer, safe.receptance, samples, kRate);
  std::vector<double> reaction = noise(samples, 5);
  remove_mean(reaction);
  const MinimalProduct rule({.curve = {.points = 40}});
  const auto curve = inversion.invert(reaction, {*regularizer, rule}).choice.curve;
  const FrequencyGrid grid = FrequencyGrid::of_record(samples, kRate);
  std::vector<Complex> transfer = safe.transfer;
  if (samples % 2 == 0) transfer.back() = transfer.back().real();
  for (const CurvePoint& point : curve) {
    const GivenParameter fixed({.value = point.parameter, .curve = {.points = 0}});
    std::vector<Complex> force =
        inversion.invert(reaction, {*regularizer, fixed, {.force_spectrum = true}}).force_spectrum;
    std::vector<Complex> modeled(force.size()), derivative(force.size());
    double power = 0.0;  // of dF/dt, by Parseval: bin K/2 of a derivative has no samples
    for (std::size_t k = 0; k < force.size(); ++k) {
      modeled[k] = transfer[k] * force[k];
      power += bin_multiplicity(k, samples) * std::norm(grid.omega(k) * force[k]);
    }
    std::vector<double> residual = safe.fft.inverse(modeled);
    for (std::size_t j = 0; j < samples; ++j) residual[j] -= reaction[j];
    // The residual is a difference of signals of norm ‖R‖: it carries 1e-14 of that. Compacted
    // sums (Tikhonov) keep 1e-11.
    EXPECT_NEAR(point.residual_norm, norm(residual),
                1e-13 * norm(reaction) + 1e-11 * norm(residual));
    const double solution = std::sqrt(power / static_cast<double>(samples));
    EXPECT_NEAR(point.solution_norm, solution, 1e-11 * solution);
    EXPECT_NEAR(point.criterion, point.residual_norm * point.solution_norm,
                1e-15 * point.criterion);
  }
}

}  // namespace
}  // namespace modcal::inversion_curve_test
