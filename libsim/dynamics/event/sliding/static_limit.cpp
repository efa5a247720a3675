#include "libsim/dynamics/event/sliding/static_limit.hpp"

#include <algorithm>
#include <array>
#include <cassert>

namespace modcal::event {

// With p = 1/(1 + e^x) and x = (ϑ − ϑ_s)/w the limit is μ_hot + (μ_cold − μ_hot) p, and
// p' = −p (1 − p) x', x' = −g (ϑ/w): the powers of p follow one after the other.
void StaticLimit::series(double tau, double time, std::span<double> out) const {
  constexpr std::size_t kMost = 32;
  assert(out.size() <= kMost);
  std::fill(out.begin(), out.end(), 0.0);
  if (!thermal_) {
    out[0] = force_;
    return;
  }
  const double decay = -cooling() * time;
  std::array<double, kMost> p{}, product{}, rate{};
  const double rise = rise_at(tau);
  rate[0] = decay * rise / thermal_->softening_width;
  for (std::size_t k = 1; k < out.size(); ++k) {
    rate[k] = rate[k - 1] * decay / static_cast<double>(k);
  }
  p[0] = thermal_->cold_share(rise);
  for (std::size_t k = 0; k + 1 < out.size(); ++k) {
    product[k] = p[k];
    for (std::size_t i = 0; i <= k; ++i) product[k] -= p[i] * p[k - i];
    double sum = 0.0;
    for (std::size_t i = 0; i <= k; ++i) sum += product[i] * rate[k - i];
    p[k + 1] = -sum / static_cast<double>(k + 1);
  }
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = thermal_->drop * p[k];
  out[0] += thermal_->hot;
}

}  // namespace modcal::event
