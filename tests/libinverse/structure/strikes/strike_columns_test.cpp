// The columns of a strike against the response that a modal sum has in time.
#include "libinverse/structure/strikes/strike_columns.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libsim/base/turn.hpp"

namespace modcal::strike_columns_test {
namespace {

// Displacement of x'' + 2ζωx' + ω²x = force, exact for a force that is linear between the samples.
std::vector<double> response_of(const ModalPole& pole, const std::vector<double>& force,
                                double rate) {
  const double step = 1.0 / rate;
  std::vector<double> result;
  double x = 0.0, v = 0.0;
  const int parts = 50;
  const double h = step / parts;
  for (std::size_t j = 0; j < force.size(); ++j) {
    result.push_back(x);
    const double next = j + 1 < force.size() ? force[j + 1] : 0.0;
    // Runge and Kutta's fourth order: its error, (ωh)⁴/120 a step, is below 1e-10 here.
    for (int i = 0; i < parts; ++i) {
      const auto slope = [&](double at, double y, double w) {
        const double share = (i + at) / parts;
        return force[j] + share * (next - force[j]) - 2.0 * pole.zeta * pole.omega * w -
               pole.omega * pole.omega * y;
      };
      const double a1 = slope(0.0, x, v), v2 = v + 0.5 * h * a1;
      const double a2 = slope(0.5, x + 0.5 * h * v, v2), v3 = v + 0.5 * h * a2;
      const double a3 = slope(0.5, x + 0.5 * h * v2, v3), v4 = v + h * a3;
      const double a4 = slope(1.0, x + h * v3, v4);
      x += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
      v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
  }
  return result;
}

class StrikeColumnsAt : public testing::TestWithParam<double> {};

// The record ends while the structure still rings at half its amplitude.
TEST_P(StrikeColumnsAt, HoldWhatRingsOnPastTheEnd) {
  const double rate = 4000.0;
  const ModalPole pole{.omega = kTurn * 40.0, .zeta = 0.01};
  StructureRecord record{.sample_rate = rate, .force = std::vector<double>(1600, 0.0)};
  for (std::size_t j = 100; j < 200; ++j) {
    record.force[j] = std::pow(std::sin(std::numbers::pi * static_cast<double>(j - 100) / 100), 2);
  }
  record.responses = {response_of(pole, record.force, rate)};
  const auto spectra = ContourSpectra::of(record, GetParam(), 10.0, 120.0);
  const StrikeColumns columns(spectra, record.force);
  const std::vector<Complex> own = columns.of(pole, {true, false, false})[0][0];
  double off = 0.0, all = 0.0;
  for (std::size_t m = 0; m < spectra.count(); ++m) {
    // A column has a modal constant of ω².
    off += std::norm(own[m] / (pole.omega * pole.omega) - spectra.responses[0][m]);
    all += std::norm(spectra.responses[0][m]);
  }
  // Sums over samples for integrals are off by (2π 40/4000)²/12 = 3e-4 of a displacement.
  EXPECT_LT(std::sqrt(off / all), 5e-4);
}

INSTANTIATE_TEST_SUITE_P(Contours, StrikeColumnsAt, testing::Values(0.0, 5.0, 50.0));

}  // namespace
}  // namespace modcal::strike_columns_test
