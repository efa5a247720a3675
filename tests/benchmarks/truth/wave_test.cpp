// The wave equation on a grid: dispersion, order, stability.
#include "benchmarks/truth/wave.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/benchmarks/truth/continuum.hpp"

namespace modcal::truth::wave_test {
namespace {

TEST(TruthWave, HasTheModesOfTheContinuumToTheEndOfTheBand) {
  const TruthString string;
  const TruthOptions options;
  const Wave wave(equation_of(string), grid_of(string, options));
  EXPECT_GE(1.0 / wave.grid().time_step, 10e6);
  for (std::size_t n = 1; n <= 70; ++n) {
    const WaveMode mode = wave.mode(n);
    // README: what these errors are worth beside the deviations of a calibration.
    const double bound = n <= 30 ? 2e-11 : n <= 40 ? 1e-9 : n <= 60 ? 3e-7 : 3e-6;
    EXPECT_NEAR(mode.omega / (2.0 * kPi * frequency(string, n)), 1.0, bound) << n;
    const double loss_bound = n <= 20 ? 2e-8 : n <= 40 ? 5e-6 : 5e-4;
    EXPECT_NEAR(mode.decay / decay(string, n), 1.0, loss_bound) << n;
  }
}

/// Observed order of mode 6 between two grids, the time step following the cells.
double observed_order(double inharmonicity, std::size_t half_width) {
  TruthString string;
  string.inharmonicity = inharmonicity;
  string.loss = string.diffusion = 0.0;
  double errors[2];
  for (std::size_t i = 0; i < 2; ++i) {
    const std::size_t cells = 40 << i;
    const Wave wave(equation_of(string), {.intervals = cells,
                                          .time_step = 1e-6 / static_cast<double>(1 << i),
                                          .half_width = half_width,
                                          .loss_half_width = half_width / 2});
    errors[i] = std::abs(wave.mode(6).omega / (2.0 * kPi * frequency(string, 6)) - 1.0);
  }
  return std::log2(errors[0] / errors[1]);
}

TEST(TruthWave, ConvergesWithTheOrderOfItsStencils) {
  EXPECT_NEAR(observed_order(0.0, 2), 4.0, 0.1);
  EXPECT_NEAR(observed_order(0.0, 4), 8.0, 0.3);
  // The fourth derivative has two orders less; a stiff string, so that its error is the larger one.
  EXPECT_NEAR(observed_order(0.1, 2), 2.0, 0.1);
  EXPECT_NEAR(observed_order(0.1, 4), 6.0, 0.3);
}

/// Decay and frequency of a sine of the grid let go: its amplitude obeys x_{i+1} = 2 e^{−σk} cos φ
/// x_i − e^{−2σk} x_{i−1}. Both numbers by least squares over every `skip`th step.
WaveMode fitted(Wave& wave, std::size_t n, std::size_t skip) {
  const WaveGrid& grid = wave.grid();
  std::vector<double> shape(grid.intervals + 1);
  for (std::size_t j = 0; j < shape.size(); ++j) {
    shape[j] = 1e-3 * std::sin(kPi * static_cast<double>(n * j) / grid.intervals);
  }
  wave.set_rest(shape);
  std::vector<double> amplitude;
  for (std::size_t i = 0; i < 60000; ++i) {
    if (i % skip == 0) {
      double sum = 0.0;
      for (std::size_t j = 1; j < grid.intervals; ++j) sum += shape[j] * wave.y()[j];
      amplitude.push_back(sum);
    }
    wave.advance();
  }
  double aa = 0.0, ab = 0.0, bb = 0.0, ac = 0.0, bc = 0.0;
  for (std::size_t i = 2; i < amplitude.size(); ++i) {
    const double a = amplitude[i - 1], b = amplitude[i - 2], c = amplitude[i];
    aa += a * a, ab += a * b, bb += b * b, ac += a * c, bc += b * c;
  }
  const double c1 = (ac * bb - bc * ab) / (aa * bb - ab * ab);
  const double c2 = -(bc * aa - ac * ab) / (aa * bb - ab * ab);
  const double step = static_cast<double>(skip) * grid.time_step;
  const double decay = -0.5 * std::log(c2) / step;
  return {.omega = std::hypot(std::acos(0.5 * c1 / std::sqrt(c2)) / step, decay), .decay = decay};
}

TEST(TruthWave, RingsWithTheModesOfItsDispersionRelation) {
  for (const std::size_t n : {1u, 5u, 20u, 40u}) {
    Wave wave(equation_of({}), {.intervals = 64, .time_step = 1.0 / 3e6});
    const WaveMode found = fitted(wave, n, n == 1 ? 256 : 16), mode = wave.mode(n);
    EXPECT_NEAR(found.omega / mode.omega, 1.0, 1e-9) << n;
    EXPECT_NEAR(found.decay / mode.decay, 1.0, 1e-7) << n;
  }
}

TEST(TruthWave, RetunesByItsTension) {
  TruthString string;
  string.inharmonicity = 0.0;
  Wave wave(equation_of(string), {.intervals = 64, .time_step = 1.0 / 3e6});
  wave.retune(2e-3);
  for (const std::size_t n : {1u, 20u}) {
    const double found = fitted(wave, n, n == 1 ? 256 : 16).omega;
    EXPECT_NEAR(found / (wave.mode(n).omega * std::sqrt(1.002)), 1.0, 1e-8) << n;
  }
}

TEST(TruthWave, RefusesGridsThatItsTimeStepCannotCarry) {
  const TruthString string;
  EXPECT_THROW(Wave(equation_of(string), {.intervals = 200, .time_step = 4e-6}),
               std::invalid_argument);
  EXPECT_THROW(Wave(equation_of(string), {.intervals = 20, .time_step = 1e-7}),
               std::invalid_argument);
}

}  // namespace
}  // namespace modcal::truth::wave_test
