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

std::array<Eigen::MatrixXd, 5> moments(std::span<const std::complex<double>> a,
                                       std::span<const std::complex<double>> b, std::size_t count) {
  std::array<Eigen::MatrixXd, 5> result;
  for (Eigen::MatrixXd& moment : result) {
    moment.resize(2 * static_cast<Eigen::Index>(a.size()), 2 * static_cast<Eigen::Index>(b.size()));
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      // exp(a) exp(b) = cc − ss + i(sc + cs) and exp(a) exp(b̄) = cc + ss + i(sc − cs).
      const Sums plus = exponential_sums(a[i] + b[j], count);
      const Sums minus = exponential_sums(a[i] + std::conj(b[j]), count);
      for (std::size_t p = 0; p < result.size(); ++p) {
        const Complex sum = 0.5 * (minus[p] + plus[p]), difference = 0.5 * (minus[p] - plus[p]);
        result[p].block<2, 2>(2 * static_cast<Eigen::Index>(i), 2 * static_cast<Eigen::Index>(j))
            << sum.real(),
            -difference.imag(), sum.imag(), difference.real();
      }
    }
  }
  return result;
}

}  // namespace modcal
