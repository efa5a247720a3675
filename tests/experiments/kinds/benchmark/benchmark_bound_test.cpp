// The bound that a benchmark's errors are held against.
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/config/reader.hpp"
#include "experiments/kinds/benchmark/benchmark.hpp"
#include "libcalib/identifiability/expected_limit.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal::benchmark_bound_test {
namespace {

CalibrateOptions options_of(const std::string& parameters, double noise) {
  const YamlDocument document = parse_yaml(
      "scene:\n"
      "  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 8}\n"
      "  bow: {position: 31 mm, velocity: 0.1 m/s, normal_force: 1 N}\n"
      "  friction: {type: coulomb_exponential, static: 0.4, dynamic: 0.2, decay: 5 s/m}\n"
      "  duration: 0.3 s\n"
      "simulator: modal_event\n"
      "measurement: {sample_rate: 12.5 kHz}\n"
      "inversion: {estimator: one_sided, regularizer: none}\n"
      "calibration:\n"
      "  parameters: {" +
          parameters + "}\n",
      "test");
  CalibrateOptions options;
  std::vector<Mistake> mistakes = document.mistakes;
  read_options(
      document.root, [&](OptionVisitor& visitor) { options.visit(visitor); }, mistakes);
  EXPECT_EQ(format_mistakes(document, mistakes), "");
  options.inversion.observation.measurement.noise_level = noise;
  return options;
}

std::vector<double> bounds(const std::string& parameters, double noise) {
  FrequencyBounds known;
  TruthCache truths;
  const FrequencyBounds::Bounds found = known.of(options_of(parameters, noise), truths);
  return found == nullptr ? std::vector<double>() : *found;
}

// Information is proportional to 1/σ², so the bound of the law is proportional to the noise, but
// for some 1e-6 that are known of the end state whatever the noise.
TEST(FrequencyBounds, GrowsWithTheNoise) {
  const std::vector<double> low = bounds("frequencies: none", 0.01);
  const std::vector<double> high = bounds("frequencies: none", 0.03);
  ASSERT_EQ(low.size(), 8u);
  for (std::size_t n = 0; n < low.size(); ++n) {
    EXPECT_GT(low[n], 0.0);
    EXPECT_NEAR(high[n] / low[n], 3.0, 2e-6);
  }
}

// Whoever knows more has a smaller bound: x_c known, then the law, against every frequency free.
TEST(FrequencyBounds, FallsWithWhatIsKnown) {
  const std::vector<double> known_contact = bounds("frequencies: none, contact: false", 0.01);
  const std::vector<double> law = bounds("frequencies: none", 0.01);
  const std::vector<double> free = bounds("law: false", 0.01);
  for (std::size_t n = 0; n < law.size(); ++n) {
    EXPECT_LE(known_contact[n], law[n] * (1.0 + 1e-9));
    EXPECT_LE(law[n], free[n] * (1.0 + 1e-9));
  }
}

// f_n = n f_0 √(1 + B n²) with B = 0: the relative deviation of f_1 is that of ln f_0 + B/2. With
// the damping among the unknowns the bound can only be larger.
TEST(FrequencyBounds, FollowsFromTheLimitOfTheLaw) {
  const CalibrateOptions options = options_of("frequencies: none", 0.01);
  TruthCache truths;
  const auto truth = truths.get(options.inversion.observation.truth, 12500.0,
                                {.force = true, .left_reaction = true, .right_reaction = true});
  NoisyRecords records{.sample_rate = 12500.0};
  records.reactions = {truth->simulation.left_reaction.samples,
                       truth->simulation.right_reaction.samples};
  for (std::size_t r = 0; r < 2; ++r) {
    remove_mean(records.reactions[r]);
    records.deviation[r] = 0.01 * standard_deviation(records.reactions[r]);
  }
  const ExpectedLimit limit =
      expected_limit({truth->basis, truth->contact}, records, std::nan(""), 2e-3);
  const double fundamental = limit.law[0] / 196.0;
  const double with_damping =
      std::sqrt(fundamental * fundamental + 0.25 * limit.law[1] * limit.law[1] +
                limit.law_correlation[0][1] * fundamental * limit.law[1]);
  FrequencyBounds known;
  const double bound = known.of(options, truths)->front();
  EXPECT_LE(bound, with_damping * (1.0 + 1e-9));
  EXPECT_GE(bound, 0.5 * with_damping);
}

TEST(FrequencyBounds, IsAbsentWithoutNoiseOrFrequencies) {
  EXPECT_TRUE(bounds("frequencies: none, contact: false", 0.0).empty());
  EXPECT_TRUE(bounds("frequencies: none, law: false", 0.01).empty());
  EXPECT_TRUE(std::isnan(rms_bound(nullptr, {1})));
}

TEST(FrequencyBounds, AveragesOverTheModesNamed) {
  const auto two = std::make_shared<std::vector<double>>(std::vector<double>{3.0, 100.0, 4.0});
  EXPECT_DOUBLE_EQ(rms_bound(two, {1, 3}), std::sqrt(12.5));
}

}  // namespace
}  // namespace modcal::benchmark_bound_test
