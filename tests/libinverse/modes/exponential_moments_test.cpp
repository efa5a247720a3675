#include "libinverse/modes/exponential_moments.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace modcal::exponential_moments_test {
namespace {

using Complex = std::complex<double>;

// A term's phase of up to 1e3 radians has an error of 1e3 ε/2, 1e-13; 777 of them, and 5e-13 where
// they cancel.
TEST(ExponentialSums, AreThoseOfTheirTerms) {
  constexpr std::size_t kCount = 777;
  for (const Complex x : {Complex(0.0), Complex(-1e-3, 0.7), Complex(-0.2, 1.3),
                          Complex(1e-3, 2e-6), Complex(-1e-9, 3.1), Complex(-40.0, 0.1)}) {
    const auto sums = exponential_sums(x, kCount);
    for (std::size_t p = 0; p < sums.size(); ++p) {
      Complex expected = 0.0;
      for (std::size_t m = 0; m < kCount; ++m) {
        const auto at = static_cast<double>(m);
        expected += std::pow(at / kCount, static_cast<double>(p)) * std::exp(x * at);
      }
      EXPECT_LT(std::abs(sums[p] - expected), 1e-12 * std::max(1.0, std::abs(expected)))
          << x << " " << p;
    }
  }
  EXPECT_EQ(exponential_sums({-0.5, 0.1}, 1)[0], Complex(1.0));
  EXPECT_EQ(exponential_sums({-0.5, 0.1}, 1)[1], Complex(0.0));
}

TEST(Moments, AreInnerProductsOfTheColumns) {
  static constexpr Eigen::Index kCount = 300;
  const std::vector<Complex> all = {{-0.01, 0.4}, {0.0, 0.0}, {-0.02, 1.1}, {-1e-4, 0.41}};
  const auto columns = [](const std::vector<Complex>& exponents) {
    Eigen::MatrixXd result(kCount, 2 * static_cast<Eigen::Index>(exponents.size()));
    for (Eigen::Index m = 0; m < kCount; ++m) {
      for (std::size_t k = 0; k < exponents.size(); ++k) {
        const Complex value = std::exp(exponents[k] * static_cast<double>(m));
        result(m, 2 * static_cast<Eigen::Index>(k)) = value.real();
        result(m, 2 * static_cast<Eigen::Index>(k) + 1) = value.imag();
      }
    }
    return result;
  };
  const auto found = moments(all, kCount);
  for (std::size_t p = 0; p < found.size(); ++p) {
    Eigen::VectorXd weights(kCount);
    for (Eigen::Index m = 0; m < kCount; ++m) {
      weights[m] = std::pow(static_cast<double>(m) / kCount, static_cast<double>(p));
    }
    const Eigen::MatrixXd expected = columns(all).transpose() * weights.asDiagonal() * columns(all);
    EXPECT_LT((found[p] - expected).cwiseAbs().maxCoeff(), 1e-11) << p;
  }
}

}  // namespace
}  // namespace modcal::exponential_moments_test
