// A search of poles whose grid looks at fewer measurements than there are.
#include "libinverse/structure/strikes/pole_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libinverse/structure/measured_functions.hpp"
#include "libsim/base/random.hpp"
#include "libsim/base/turn.hpp"

namespace modcal::pole_search_test {
namespace {

// Two of them 6 % apart.
const std::vector<ModalPole> kPoles = {
    {kTurn * 70.0, 0.01}, {kTurn * 74.0, 0.008}, {kTurn * 130.0, 0.006}, {kTurn * 190.0, 0.012}};

// A session of two displacements, 2 % of noise.
Transfers session_of(const FrequencyGrid& grid, std::uint64_t seed) {
  std::vector<double> normal(4 * grid.bins);
  fill_standard_normal(StreamKey(seed).with("lines"), normal);
  Transfers response(2, std::vector<Complex>(grid.bins));
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t m = 0; m < grid.bins; ++m) {
      for (std::size_t n = 0; n < kPoles.size(); ++n) {
        const double sign = (k + n) % 2 == 0 ? 1.0 : -0.6;
        response[k][m] += sign / kPoles[n].denominator(grid.s(m));
      }
      const double* z = &normal[2 * (k * grid.bins + m)];
      response[k][m] *= 1.0 + 0.02 / std::sqrt(2.0) * Complex(z[0], z[1]);
    }
  }
  return response;
}

std::vector<ModalPole> found(const std::vector<ContourSpectra>& spectra,
                             const std::vector<SensorKind>& kinds, double grid_numbers) {
  std::vector<std::vector<std::vector<double>>> weights;
  for (const ContourSpectra& own : spectra) {
    std::vector<std::vector<double>>& rows = weights.emplace_back();
    for (const std::vector<Complex>& response : own.responses) {
      std::vector<double>& row = rows.emplace_back();
      for (const Complex& y : response) row.push_back(1.0 / (0.02 * std::abs(y)));
    }
  }
  std::vector<SearchedStrike> strikes;
  for (std::size_t i = 0; i < spectra.size(); ++i) {
    strikes.push_back({spectra[i], std::span<const double>(), weights[i]});
  }
  PoleSearch search(strikes, kinds, grid_numbers);
  std::vector<ModalPole> poles;
  while (poles.size() < kPoles.size()) {
    poles.push_back(search.best_addition(poles));
    search.fit(poles, 30);
  }
  std::ranges::sort(poles, {}, &ModalPole::omega);
  return poles;
}

TEST(PoleSearch, FindsTheSamePolesByAGridOfOneOfTheSessions) {
  MeasuredFunctions functions{.grid = {.spacing = kTurn * 0.5, .bins = 501},
                              .sensors = std::vector(2, SensorKind::kDisplacement)};
  std::vector<ContourSpectra> spectra;
  for (const std::uint64_t seed : {1, 2, 3}) {
    functions.sessions.push_back(session_of(functions.grid, seed));
    spectra.push_back(functions.lines(functions.sessions.size() - 1, 40.0, 240.0));
  }
  const std::vector<ModalPole> by_all = found(spectra, functions.sensors, 1e9);
  const std::vector<ModalPole> by_one = found(spectra, functions.sensors, 1.0);
  for (std::size_t n = 0; n < kPoles.size(); ++n) {
    // 400 lines of 2 % in each of six rows tell ln f to some 1e-5 and ln ζ to some 1e-3.
    EXPECT_NEAR(std::log(by_all[n].omega / kPoles[n].omega), 0.0, 2e-4) << n;
    EXPECT_NEAR(std::log(by_all[n].zeta / kPoles[n].zeta), 0.0, 2e-2) << n;
    // Both end in one minimum, where a step takes less than 1e-7 of the cost: of χ² = 2400
    // 2.4e-4, a fortieth of a deviation.
    EXPECT_NEAR(std::log(by_one[n].omega / by_all[n].omega), 0.0, 5e-6) << n;
    EXPECT_NEAR(std::log(by_one[n].zeta / by_all[n].zeta), 0.0, 5e-4) << n;
  }
}

}  // namespace
}  // namespace modcal::pole_search_test
