#include "experiments/study/sample.hpp"

#include <algorithm>

#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"

namespace modcal {
namespace {

constexpr std::size_t kResamples = 1000;

double log_ratio(double ours, double theirs) {
  return ours == theirs ? 0.0 : std::log(ours / theirs);
}

// Median as quantile(values, 0.5) gives it, without sorting all.
double median(std::vector<double>& values) {
  const std::size_t n = values.size();
  const auto upper = values.begin() + static_cast<std::ptrdiff_t>(n / 2);
  std::nth_element(values.begin(), upper, values.end());
  if (n % 2 == 1) return *upper;
  return std::lerp(*std::max_element(values.begin(), upper), *upper, 0.5);
}

}  // namespace

BootstrapMedians::BootstrapMedians(std::span<const double> draws) : n(draws.size()) {
  MODCAL_REQUIRE(n > 0, "no draws: a median needs at least one");
  std::vector<double> values(draws.begin(), draws.end());
  all = median(values);
  std::vector<double> uniform(n);
  resampled.reserve(kResamples);
  for (std::size_t resample = 0; resample < kResamples; ++resample) {
    fill_uniform(StreamKey(1).with("paired bootstrap").with(resample), uniform);
    for (std::size_t i = 0; i < n; ++i) {
      const auto drawn = static_cast<std::size_t>(uniform[i] * static_cast<double>(n));
      values[i] = draws[std::min(drawn, n - 1)];
    }
    resampled.push_back(median(values));
  }
}

MedianRatio median_ratio(const BootstrapMedians& a, const BootstrapMedians& b) {
  MODCAL_REQUIRE(a.n == b.n, "{} and {} draws: paired draws are as many", a.n, b.n);
  std::vector<double> ratios(kResamples);
  for (std::size_t i = 0; i < kResamples; ++i) {
    ratios[i] = log_ratio(a.resampled[i], b.resampled[i]);
  }
  return {a.n, std::exp(log_ratio(a.all, b.all)), std::exp(quantile(ratios, 0.025)),
          std::exp(quantile(ratios, 0.975))};
}

MedianRatio median_ratio(std::span<const double> a, std::span<const double> b) {
  MODCAL_REQUIRE(a.size() == b.size() && !a.empty(),
                 "{} and {} draws: paired draws are as many, at least one", a.size(), b.size());
  return median_ratio(BootstrapMedians(a), BootstrapMedians(b));
}

}  // namespace modcal
