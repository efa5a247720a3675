#include "experiments/study/paired_bootstrap.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

double log_ratio(std::vector<double> a, std::vector<double> b) {
  const double ours = quantile(std::move(a), 0.5);
  const double theirs = quantile(std::move(b), 0.5);
  return ours == theirs ? 0.0 : std::log(ours / theirs);
}

}  // namespace

MedianRatio median_ratio(std::span<const double> a, std::span<const double> b) {
  MODCAL_REQUIRE(a.size() == b.size() && !a.empty(),
                 "{} and {} draws: paired draws are as many, at least one", a.size(), b.size());
  constexpr std::size_t kResamples = 1000;
  const std::size_t n = a.size();
  std::vector<double> uniform(n), ratios;
  for (std::size_t resample = 0; resample < kResamples; ++resample) {
    fill_uniform(StreamKey(1).with("paired bootstrap").with(resample), uniform);
    std::vector<double> drawn_a, drawn_b;
    for (const double u : uniform) {
      const std::size_t i = std::min(static_cast<std::size_t>(u * static_cast<double>(n)), n - 1);
      drawn_a.push_back(a[i]);
      drawn_b.push_back(b[i]);
    }
    ratios.push_back(log_ratio(std::move(drawn_a), std::move(drawn_b)));
  }
  return {n, std::exp(log_ratio({a.begin(), a.end()}, {b.begin(), b.end()})),
          std::exp(quantile(ratios, 0.025)), std::exp(quantile(ratios, 0.975))};
}

}  // namespace modcal
