// Modes from strikes whose force was measured with noise.
#include "libinverse/structure/strikes/force_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libsim/base/random.hpp"
#include "libsim/base/turn.hpp"

namespace modcal::force_noise_test {
namespace {

constexpr double kRate = 2000.0;
constexpr std::size_t kSamples = 2000, kSensors = 4, kDraws = 24;
const std::vector<ModalPole> kPoles = {{kTurn * 110.0, 0.02}, {kTurn * 173.0, 0.01}};

struct Strike {
  std::vector<double> blow = {100.0};  // samples after 50 ms [N]
  std::size_t sensors = kSensors;
};

// Answered exactly; noise of the force [N], and of every response as a share of its largest.
StructureRecord struck(std::uint64_t draw, double of_force, double of_response,
                       const Strike& strike) {
  StructureRecord record{.sample_rate = kRate, .force = std::vector<double>(kSamples)};
  const auto noise = [draw](const char* name, std::size_t k) {
    std::vector<double> normal(kSamples);
    fill_standard_normal(StreamKey(draw).with(name).with(k), normal);
    return normal;
  };
  const std::vector<double> in_force = noise("force", 0);
  for (std::size_t j = 0; j < kSamples; ++j) record.force[j] = of_force * in_force[j];
  for (std::size_t i = 0; i < strike.blow.size(); ++i) record.force[100 + i] += strike.blow[i];
  for (std::size_t k = 0; k < strike.sensors; ++k) {
    std::vector<double>& response = record.responses.emplace_back(kSamples);
    for (std::size_t n = 0; n < kPoles.size(); ++n) {
      const auto [omega, zeta] = kPoles[n];
      const double damped = omega * std::sqrt(1.0 - zeta * zeta);
      const double constant = std::cos(1.0 + static_cast<double>(k + 2 * n));
      for (std::size_t i = 0; i < strike.blow.size(); ++i) {
        for (std::size_t j = 101 + i; j < kSamples; ++j) {
          const double t = static_cast<double>(j - 100 - i) / kRate;
          response[j] += strike.blow[i] / kRate * constant / damped * std::exp(-zeta * omega * t) *
                         std::sin(damped * t);
        }
      }
    }
    double largest = 0.0;
    for (const double x : response) largest = std::max(largest, std::abs(x));
    const std::vector<double> own = noise("response", k);
    for (std::size_t j = 0; j < kSamples; ++j) response[j] += of_response * largest * own[j];
  }
  return record;
}

// Mean square of what ln f and ln ζ are off by, over their deviations.
double mean_square(double of_force, double of_response, const Strike& strike = {}) {
  double sum = 0.0;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    const StrikeFit fit =
        fit_strikes({struck(draw, of_force, of_response, strike)},
                    std::vector<SensorKind>(strike.sensors, SensorKind::kDisplacement),
                    {.low = 50.0, .high = 300.0, .most_modes = 2});
    for (std::size_t n = 0; n < 2; ++n) {
      const ModalPole& found = fit.table.model.poles[n];
      const double f = std::log(found.omega / kPoles[n].omega) / fit.table.frequency_deviations[n];
      const double zeta = std::log(found.zeta / kPoles[n].zeta) / fit.table.damping_deviations[n];
      sum += (f * f + zeta * zeta) / (4.0 * kDraws);
    }
  }
  return sum;
}

// 96 squares of normal numbers have a mean of 1 ± .14; that of the force's noise is known to a
// fifth. All sensors answer to it alike: taken for noise of each, the mean is that of kSensors.
TEST(ForceNoise, IsInTheDeviationsOfTheModes) {
  EXPECT_NEAR(mean_square(0.0, 1e-3), 1.0, 0.5);
  EXPECT_NEAR(mean_square(0.03, 1e-6), 1.0, 0.7);
}

// One sensor does not tell it from its own. The blow of 12 ms has a zero at 167 Hz, where the force
// is no more than its noise: what it reads while it is quiet tells that. Without it the mean is 60.
TEST(ForceNoise, OfOneSensorIsWhatTheForceReadsWhileItIsQuiet) {
  Strike soft{.blow = {}, .sensors = 1};
  for (int j = 0; j <= 24; ++j) soft.blow.push_back(100.0 * std::pow(std::sin(M_PI * j / 24.0), 2));
  EXPECT_LT(mean_square(0.1, 1e-4, soft), 2.0);
}

TEST(ForceNoise, IsQuietWhereNothingStrikes) {
  const StructureRecord record = struck(1, 0.05, 0.0, {});
  EXPECT_NEAR(quiet_level(record.force), 0.05, 0.005);
  std::vector<double> always(kSamples);
  fill_standard_normal(StreamKey(1).with("force"), always);
  EXPECT_EQ(quiet_level(always), 0.0);
}

}  // namespace
}  // namespace modcal::force_noise_test
