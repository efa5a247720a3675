#include "benchmarks/truth/stencil.hpp"

#include <cmath>

namespace modcal::truth {
namespace {

/// C(n, k).
long double binomial(std::size_t n, std::size_t k) {
  long double value = 1.0L;
  for (std::size_t i = 1; i <= k; ++i) value = value * static_cast<long double>(n - k + i) / i;
  return std::round(value);
}

/// a(X) as a series in S = 4 sin²(θ/2), by Horner's rule.
Series in_sines(const Series& a) {
  Series x(a.size(), 0.0L);
  for (std::size_t m = 1; m < x.size(); ++m) x[m] = 2.0L / (m * m * binomial(2 * m, m));
  Series sum(a.size(), 0.0L);
  for (std::size_t m = a.size(); m-- > 0;) {
    sum = product(sum, x);
    sum[0] += a[m];
  }
  return sum;
}

/// Taps of Σ_m b_m S^m: S^m has (−1)^i C(2m, m + i) at distance i.
std::vector<long double> taps_of(const Series& b) {
  std::vector<long double> taps(b.size(), 0.0L);
  for (std::size_t m = 0; m < b.size(); ++m) {
    for (std::size_t i = 0; i <= m; ++i) {
      taps[i] += (i % 2 == 0 ? b[m] : -b[m]) * binomial(2 * m, m + i);
    }
  }
  return taps;
}

}  // namespace

Series product(const Series& a, const Series& b) {
  Series c(a.size(), 0.0L);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; i + j < a.size(); ++j) c[i + j] += a[i] * b[j];
  }
  return c;
}

Series exponential(const Series& a) {
  Series e(a.size(), 0.0L);
  e[0] = std::exp(a[0]);
  for (std::size_t m = 1; m < a.size(); ++m) {
    for (std::size_t k = 1; k <= m; ++k) e[m] += k * a[k] * e[m - k] / m;
  }
  return e;
}

Series cosine_of_root(const Series& a) {
  Series sum(a.size(), 0.0L), term(a.size(), 0.0L);
  term[0] = 1.0L;
  for (std::size_t m = 1; m <= a.size() + 4; ++m) {
    for (std::size_t i = 0; i < a.size(); ++i) sum[i] += term[i];
    term = product(term, a);
    for (long double& t : term) t /= -1.0L * (2 * m) * (2 * m - 1);
  }
  return sum;
}

SymmetricStencil::SymmetricStencil(std::vector<double> taps) : taps_(std::move(taps)) {
  long double sum = taps_[0];
  for (std::size_t i = 1; i < taps_.size(); ++i) sum += 2.0L * taps_[i];
  at_zero_ = static_cast<double>(sum);
}

double SymmetricStencil::symbol(double theta) const {
  double sum = at_zero_;
  for (std::size_t i = 1; i < taps_.size(); ++i) {
    const double s = std::sin(0.5 * theta * static_cast<double>(i));
    sum -= 4.0 * taps_[i] * s * s;
  }
  return sum;
}

SymmetricStencil matched_stencil(const Series& series) {
  const std::vector<long double> exact = taps_of(in_sines(series));
  std::vector<double> taps(exact.begin(), exact.end());
  // The constant symbol is what the differences of large neighbors leave: the middle tap keeps it.
  long double middle = series[0];
  for (std::size_t i = 1; i < taps.size(); ++i) middle -= 2.0L * taps[i];
  taps[0] = static_cast<double>(middle);
  return SymmetricStencil(std::move(taps));
}

std::vector<double> matched_odd_weights(const Series& series) {
  // θ a(X) = sin θ · a(X) θ/sin θ with θ/sin θ = Σ (m!)²/(2m + 1)! S^m.
  Series quotient(series.size(), 0.0L);
  quotient[0] = 1.0L;
  for (std::size_t m = 1; m < series.size(); ++m) {
    quotient[m] = quotient[m - 1] * m * m / ((2 * m) * (2 * m + 1));
  }
  std::vector<long double> even = taps_of(product(in_sines(series), quotient));
  even.resize(series.size() + 2, 0.0L);
  std::vector<double> weights(series.size());
  // 2 sin θ cos iθ = sin (i + 1)θ − sin (i − 1)θ.
  for (std::size_t j = 1; j <= weights.size(); ++j) {
    weights[j - 1] = static_cast<double>(even[j - 1] - even[j + 1]);
  }
  return weights;
}

Interpolation interpolation_at(double position, std::size_t points) {
  const double below = std::floor(position);
  Interpolation result{.first = static_cast<std::size_t>(below) + 1 - points / 2,
                       .weights = std::vector<double>(points, 1.0)};
  const double from_first = position - static_cast<double>(result.first);
  for (std::size_t i = 0; i < points; ++i) {
    for (std::size_t j = 0; j < points; ++j) {
      if (i == j) continue;
      const double distance = static_cast<double>(i) - static_cast<double>(j);
      result.weights[i] *= (from_first - static_cast<double>(j)) / distance;
    }
  }
  return result;
}

}  // namespace modcal::truth
