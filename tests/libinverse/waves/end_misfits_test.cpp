#include "libinverse/waves/end_misfits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "libinverse/waves/end_search.hpp"

namespace modcal::end_misfits_test {
namespace {

// 300 bins, more than are multiplied up before a logarithm and no whole number of vectors.
EndBins bins() {
  EndBins bins{.variance = {0.5, 0.25}, .error = 0.05};
  for (int i = 0; i < 300; ++i) {
    bins.frequency.push_back(90.0 + 7.0 * i);
    bins.left.push_back(5.0 + 4.0 * std::cos(1.3 * i));
    bins.right.push_back(3.0 + 2.0 * std::sin(0.9 * i));
    bins.product.push_back(std::sqrt(bins.left.back() * bins.right.back()) * std::cos(0.7 * i));
  }
  return bins;
}

double misfit(const EndBins& bins, std::size_t i, double a, double b) {
  const double power = a * a * bins.left[i] + b * b * bins.right[i];
  const double allowed = a * a * bins.variance[0] + b * b * bins.variance[1] + 0.0025 * power;
  return std::log(1.0 + (power - 2.0 * a * b * bins.product[i]) / allowed);
}

// n by bisection of n √(1 + B n²) = f/f₀.
double mode_number(double ratio, double inharmonicity) {
  double low = 0.0, high = ratio;
  for (int i = 0; i < 100; ++i) {
    const double n = 0.5 * (low + high);
    (n * std::sqrt(1.0 + inharmonicity * n * n) < ratio ? low : high) = n;
  }
  return 0.5 * (low + high);
}

// Sums of 300 logarithms of order 1; arguments of the sine, up to 25, err by 1e-15 of themselves,
// and 1/v makes 20 times as much of it.
constexpr double kRounding = 300.0 * 1e-12;

TEST(EndMisfits, AreThoseOfEveryStringOfTheRow) {
  const EndBins all = bins();
  const StringRow row{.fundamental = 293.0, .inharmonicity = 1e-4, .contact = 0.1, .step = 0.03};
  std::vector<StringMisfits> sums(5), alone(5);
  sum_misfits(powers_of(all), row, false, sums);
  sum_misfits(powers_of(all), row, true, alone);
  for (std::size_t x = 0; x < sums.size(); ++x) {
    StringMisfits expected{};
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double wave =
          std::numbers::pi * mode_number(all.frequency[i] / row.fundamental, row.inharmonicity);
      const double contact = row.contact + row.step * static_cast<double>(x);
      const double a = std::sin(wave * contact), b = std::sin(wave * (1.0 - contact));
      expected[0] += misfit(all, i, a, b);
      expected[1] += misfit(all, i, a, -b);
      expected[2] += misfit(all, i, b, a);
      expected[3] += misfit(all, i, b, -a);
    }
    for (std::size_t h = 0; h < 4; ++h) EXPECT_NEAR(sums[x][h], expected[h], kRounding) << x << h;
    EXPECT_NEAR(alone[x][0], expected[0], kRounding) << x;
  }
}

}  // namespace
}  // namespace modcal::end_misfits_test
