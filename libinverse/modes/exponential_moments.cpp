#include "libinverse/modes/exponential_moments.hpp"

#include <bit>
#include <cmath>

namespace modcal {

namespace {

using Complex = std::complex<double>;
using Sums = std::array<Complex, 5>;  // of m^p exp(xm)

// Σ_{n ≤ m < n + k} of the sums over m < k: (m + n)^p by the binomial theorem.
Sums shifted(const Sums& sums, Complex x, double n) {
  const Complex factor = std::exp(x * n);
  constexpr std::array<std::array<double, 5>, 5> kBinomial = {
      {{1, 0, 0, 0, 0}, {1, 1, 0, 0, 0}, {1, 2, 1, 0, 0}, {1, 3, 3, 1, 0}, {1, 4, 6, 4, 1}}};
  Sums result{};
  for (std::size_t p = 0; p < result.size(); ++p) {
    double power = 1.0;
    for (std::size_t q = p + 1; q-- > 0;) {
      result[p] += kBinomial[p][q] * power * sums[q];
      power *= n;
    }
    result[p] *= factor;
  }
  return result;
}

}  // namespace

std::array<std::complex<double>, 5> exponential_sums(std::complex<double> x, std::size_t count) {
  Sums sums{};
  std::size_t length = 0;
  for (std::size_t bit = std::bit_floor(count); bit > 0; bit >>= 1) {
    const auto add = [&sums](const Sums& more) {
      for (std::size_t p = 0; p < sums.size(); ++p) sums[p] += more[p];
    };
    add(shifted(sums, x, static_cast<double>(length)));
    length *= 2;
    if ((count & bit) == 0) continue;
    add(shifted({1.0, 0.0, 0.0, 0.0, 0.0}, x, static_cast<double>(length)));
    ++length;
  }
  double scale = 1.0;
  for (Complex& sum : sums) {
    sum *= scale;
    scale /= static_cast<double>(count);
  }
  return sums;
}

std::array<Eigen::MatrixXd, 5> moments(std::span<const std::complex<double>> exponents,
                                       std::size_t count) {
  const auto size = static_cast<Eigen::Index>(exponents.size());
  std::array<Eigen::MatrixXd, 5> result;
  result.fill(Eigen::MatrixXd(2 * size, 2 * size));
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const Complex a = exponents[static_cast<std::size_t>(i)];
      const Complex b = exponents[static_cast<std::size_t>(j)];
      // exp(a) exp(b) = cc − ss + i(sc + cs) and exp(a) exp(b̄) = cc + ss + i(sc − cs).
      const Sums plus = exponential_sums(a + b, count);
      const Sums minus = exponential_sums(a + std::conj(b), count);
      for (std::size_t p = 0; p < result.size(); ++p) {
        const Complex sum = 0.5 * (minus[p] + plus[p]), difference = 0.5 * (minus[p] - plus[p]);
        Eigen::Matrix2d block;
        block << sum.real(), -difference.imag(), sum.imag(), difference.real();
        result[p].block<2, 2>(2 * i, 2 * j) = block;
        result[p].block<2, 2>(2 * j, 2 * i) = block.transpose();
      }
    }
  }
  return result;
}

}  // namespace modcal
