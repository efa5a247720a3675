#include "libinverse/joint/ringing_columns.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace modcal::ringing_columns_test {
namespace {

using Complex = std::complex<double>;

// Numbers of order 1, at most 1/(1 - 0.9) = 10, and a dozen operations.
constexpr double kRounding = 1e-13;
constexpr std::size_t kBins = 24;

std::vector<RingingMode> modes() {
  return {{.pole = std::polar(0.9, 0.4), .left = 0.7, .right = -0.8, .own = {0.3, -1.2}},
          {.pole = std::polar(0.8, 2.1), .left = -1.1, .right = 0.4, .own = {-0.6, 0.5}}};
}

Complex delay_at(std::size_t k) { return std::polar(1.0, -0.1 * static_cast<double>(k)); }
Complex left_at(std::size_t k) { return {std::cos(0.3 * static_cast<double>(k)), 0.4}; }
Complex right_at(std::size_t k) { return {0.2, std::sin(0.7 * static_cast<double>(k))}; }
double weight_at(std::size_t k) { return 0.1 * static_cast<double>(k) - 1.0; }

PlanarVector delays() {
  PlanarVector delay(kBins);
  for (std::size_t k = 0; k < kBins; ++k) delay.set(k, delay_at(k));
  return delay;
}

// Σ_j Re(c E^j) z^−j, until nothing is left of it: 0.9^400 = 5e-19.
Complex transform(Complex amplitude, Complex pole, Complex delay) {
  Complex sum, power = 1.0, turn = 1.0;
  for (int j = 0; j < 400; ++j) {
    sum += (amplitude * power).real() * turn;
    power *= pole;
    turn *= delay;
  }
  return sum;
}

TEST(RingingColumns, AreTransformsOfWhatRings) {
  RingingFactors factors(kBins);
  for (std::size_t k = 0; k < kBins; ++k) factors.set(k, left_at(k), right_at(k), weight_at(k));
  AlignedVector columns(4 * kColumnLength);
  const std::vector<RingingMode> all = modes();
  fill_ringing_columns(all, delays(), factors, columns.data());
  for (std::size_t n = 0; n < all.size(); ++n) {
    for (std::size_t part = 0; part < 2; ++part) {
      const Complex unit = part == 0 ? Complex(1.0, 0.0) : Complex(0.0, 1.0);
      const double* column = columns.data() + (2 * n + part) * kColumnLength;
      for (std::size_t k = 0; k < kBins; ++k) {
        const Complex by = all[n].left * left_at(k) + all[n].right * right_at(k);
        const Complex expected =
            by * transform(unit, all[n].pole, delay_at(k)) +
            weight_at(k) * transform(unit * all[n].own, all[n].pole, delay_at(k));
        EXPECT_NEAR(std::abs(Complex(column[k], column[kBins + k]) - expected), 0.0,
                    kRounding * 20.0)
            << n << ' ' << part << ' ' << k;
      }
    }
  }
}

TEST(RingingColumns, AddUpByEnds) {
  PlanarVector left(kBins), right(kBins);
  for (std::size_t k = 0; k < kBins; ++k) left.set(k, 2.0), right.set(k, left_at(k));
  add_ringing(modes(), delays(), left, right);
  for (std::size_t k = 0; k < kBins; ++k) {
    Complex left_sum = 2.0, right_sum = left_at(k);
    for (const RingingMode& mode : modes()) {
      const Complex own = transform(mode.own, mode.pole, delay_at(k));
      left_sum += mode.left * own;
      right_sum += mode.right * own;
    }
    EXPECT_NEAR(std::abs(left.at(k) - left_sum), 0.0, kRounding * 20.0) << k;
    EXPECT_NEAR(std::abs(right.at(k) - right_sum), 0.0, kRounding * 20.0) << k;
  }
}

TEST(RingingColumns, SmearByLinesOnBothSides) {
  std::vector<double> from;
  for (int i = 0; i < 20; ++i) from.push_back(std::cos(1.0 * i * i));
  const std::vector<double> lines = {0.9, -0.4, 0.25};
  AlignedVector to(16);
  smear(lines, from.data(), 16, to.data());
  for (std::size_t k = 0; k < 16; ++k) {
    const double expected =
        0.9 * from[k + 2] - 0.4 * (from[k + 1] + from[k + 3]) + 0.25 * (from[k] + from[k + 4]);
    EXPECT_NEAR(to[k], expected, kRounding) << k;
  }
}

}  // namespace
}  // namespace modcal::ringing_columns_test
