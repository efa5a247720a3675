// Measured response functions on another contour, and what sessions and coherence say of them.
#include "libinverse/structure/measured_functions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libsim/base/turn.hpp"
#include "tests/refusal.hpp"

namespace modcal::measured_functions_test {
namespace {

constexpr std::size_t kLines = 801;

// Two modes as a sum over poles, without the code of the models.
Complex response(Complex s, int power) {
  Complex sum;
  for (const auto& [frequency, ratio, constant] :
       {std::tuple(60.0, 0.02, 1.5), std::tuple(143.0, 0.015, -0.8)}) {
    const double omega = kTurn * frequency;
    sum += constant / (s * s + 2.0 * ratio * omega * s + omega * omega);
  }
  return sum * (power == 2 ? s * s : 1.0);
}

// At lines half a hertz apart up to 400 Hz.
MeasuredFunctions measured(SensorKind kind, double sigma = 0.0) {
  MeasuredFunctions functions{.grid = {.spacing = kTurn * 0.5, .bins = kLines, .sigma = sigma},
                              .sensors = {kind}};
  std::vector<Complex> values;
  for (std::size_t l = 0; l < kLines; ++l) {
    values.push_back(response(functions.grid.s(l), kind == SensorKind::kAcceleration ? 2 : 0));
  }
  functions.sessions.push_back({values});
  return functions;
}

// A record of .7 s, whose bins are none of the lines.
ContourSpectra bins_on(double sigma) {
  return ContourSpectra::of({.sample_rate = 2000.0, .responses = {std::vector<double>(1400, 0.0)}},
                            sigma, 20.0, 250.0);
}

double largest_error(const std::vector<Complex>& found, const ContourSpectra& spectra, int power) {
  double most = 0.0, size = 0.0;
  for (std::size_t m = 0; m < spectra.count(); ++m) {
    const Complex truth = response(spectra.s(m), power);
    most = std::max(most, std::abs(found[m] - truth));
    size = std::max(size, std::abs(truth));
  }
  return most / size;
}

// What rings after 2 s has exp(−ζω 2 s) = 3e-7. A displacement has little above the last line.
TEST(MeasuredFunctions, OfADisplacementAreKnownOnEveryContour) {
  const MeasuredFunctions functions = measured(SensorKind::kDisplacement);
  for (const double sigma : {0.0, 3.0, 25.0}) {
    const ContourSpectra spectra = bins_on(sigma);
    EXPECT_LT(largest_error(functions.at(spectra)[0], spectra, 0), 1e-4) << sigma;
  }
}

// 150 Hz below the last line a contour of 25 1/s weighs what is above it by atan(25/943)/π = .8 %;
// it differs from its continuation by less than a tenth of the peak.
TEST(MeasuredFunctions, OfAnAccelerationAreTheirContinuationAboveTheLastLine) {
  const MeasuredFunctions functions = measured(SensorKind::kAcceleration);
  EXPECT_LT(largest_error(functions.at(bins_on(0.0))[0], bins_on(0.0), 2), 1e-4);
  const ContourSpectra spectra = bins_on(25.0);
  EXPECT_LT(largest_error(functions.at(spectra)[0], spectra, 2), 8e-4);
}

TEST(MeasuredFunctions, OfAWindowStandOnItsContour) {
  const MeasuredFunctions functions = measured(SensorKind::kDisplacement, 10.0);
  const ContourSpectra spectra = bins_on(25.0);
  EXPECT_LT(largest_error(functions.at(spectra)[0], spectra, 0), 1e-4);
  EXPECT_THAT(refusal_of([&] { functions.at(bins_on(5.0)); }),
              testing::HasSubstr("contours of 10 1/s and more, not of 5"));
}

TEST(MeasuredFunctions, ThatRingOnBeyondTheirLinesSaySo) {
  EXPECT_LT(measured(SensorKind::kDisplacement).rings_on(), 1e-3);
  MeasuredFunctions coarse = measured(SensorKind::kDisplacement);
  // Every tenth line: .2 s, after which the first mode has a fifth left.
  std::vector<Complex> few;
  for (std::size_t l = 0; l < kLines; l += 10) few.push_back(coarse.sessions[0][0][l]);
  coarse.grid.spacing *= 10.0;
  coarse.grid.bins = few.size();
  coarse.sessions = {{few}};
  EXPECT_GT(coarse.rings_on(), 0.1);
}

TEST(MeasuredFunctions, OfALineThatIsNotFiniteAreRefused) {
  MeasuredFunctions functions = measured(SensorKind::kDisplacement);
  functions.sessions[0][0][40] = NAN;
  EXPECT_THAT(refusal_of([&] { functions.at(bins_on(0.0)); }), testing::HasSubstr("line 40"));
  // Lines below the first one are continued as the static response.
  functions = measured(SensorKind::kDisplacement);
  for (std::size_t l = 0; l < 10; ++l) functions.sessions[0][0][l] = NAN;
  EXPECT_LT(largest_error(functions.at(bins_on(0.0))[0], bins_on(0.0), 0), 1e-3);
}

double mean_square_of_draws(const MeasuredFunctions& functions, const ContourSpectra& spectra,
                            std::size_t m) {
  const Complex mean = functions.at(spectra)[0][m];
  constexpr std::size_t kDraws = 400;
  double sum = 0.0;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    sum += std::norm(functions.drawn(spectra, 1.0, 7, draw)[0][m] - mean) / kDraws;
  }
  return sum;
}

// Sessions of gains 1 ± .02 scatter by .02 √2 about their mean, of which a third session is off by
// √1.5 as much; a draw is as much wider as Student's t of one degree of freedom is. Of 400 squares
// of a normal number the mean scatters by 7 %.
TEST(MeasuredFunctions, OfSessionsAreOffAsTheseDiffer) {
  MeasuredFunctions functions = measured(SensorKind::kDisplacement);
  functions.sessions.push_back(functions.sessions[0]);
  for (std::size_t l = 0; l < kLines; ++l) {
    functions.sessions[0][0][l] *= 1.02;
    functions.sessions[1][0][l] *= 0.98;
  }
  const ContourSpectra spectra = bins_on(25.0);
  const std::size_t m = 60;
  // |H|² over the 3 Hz to both sides that it is averaged over.
  double flank = 0.0;
  for (std::size_t i = m - 2; i <= m + 2; ++i) flank += std::norm(response(spectra.s(i), 0)) / 5.0;
  const double expected = 1.5 * 2.0 * 0.02 * 0.02;
  EXPECT_NEAR(functions.variances(spectra)[0][m] / flank, expected, 1e-3 * expected);
  const double wide = 12.7062 / 1.959964;  // quantiles of tables
  EXPECT_NEAR(mean_square_of_draws(functions, spectra, m) / std::norm(response(spectra.s(m), 0)),
              expected * wide * wide, 0.3 * expected * wide * wide);
}

// Noise of every line by itself, 1e-4 of |H|². On the lines' own contour and at a line it is the
// line's; elsewhere that of the peaks reaches to the bins between. Draws tell it to 7 %.
TEST(MeasuredFunctions, OfACoherenceAreOffByTheirLines) {
  MeasuredFunctions functions = measured(SensorKind::kDisplacement);
  const MeasuredFunctions exact = functions;
  functions.random.push_back(std::vector<double>(kLines, 1e-4));
  for (const double sigma : {0.0, 5.0, 25.0}) {
    const ContourSpectra spectra = bins_on(sigma);
    std::vector<double> variances = functions.variances(spectra)[0];
    // What lies above the last line is drawn by nothing.
    const std::vector<double> besides = exact.variances(spectra)[0];
    for (std::size_t m = 0; m < variances.size(); ++m) variances[m] -= besides[m];
    for (const std::size_t m : {28, 60, 130}) {
      EXPECT_NEAR(mean_square_of_draws(functions, spectra, m) / variances[m], 1.0, 0.2)
          << sigma << " " << m;
    }
  }
  const ContourSpectra lines = ContourSpectra::of(
      {.sample_rate = 2000.0, .responses = {std::vector<double>(4000, 0.0)}}, 0.0, 20.0, 250.0);
  EXPECT_NEAR(functions.variances(lines)[0][80] / (1e-4 * std::norm(response(lines.s(80), 0))), 1.0,
              1e-9);
}

// A stated scatter of 5 %: a factor of its own for every sensor.
TEST(MeasuredFunctions, AreOffByTheScatterThatIsStated) {
  MeasuredFunctions functions = measured(SensorKind::kDisplacement);
  functions.scatter = {0.05};
  const ContourSpectra spectra = bins_on(25.0);
  EXPECT_NEAR(mean_square_of_draws(functions, spectra, 60) / std::norm(response(spectra.s(60), 0)),
              0.0025, 0.2 * 0.0025);
}

}  // namespace
}  // namespace modcal::measured_functions_test
