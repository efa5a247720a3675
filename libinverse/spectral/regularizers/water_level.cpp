#include "libinverse/spectral/regularizers/water_level.hpp"

namespace modcal {

void WaterLevel::do_filter_factors(std::span<const double> sigma, double parameter,
                                   std::span<double> kept, std::span<double> lost) const {
  for (std::size_t i = 0; i < sigma.size(); ++i) kept[i] = sigma[i] > parameter ? 1.0 : 0.0;
  for (std::size_t i = 0; i < lost.size(); ++i) lost[i] = 1.0 - kept[i];
}

// The residual is gathered from the smallest σ up and the solution from the largest down: both are
// sums of positive terms, so neither cancels.
void WaterLevel::do_trace_squares(const SpectralSystem& system, std::span<const double> parameters,
                                  std::span<CurvePoint> curve) const {
  double residual = system.outside_power;
  std::size_t tail = system.size();
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    while (tail > 0 && !(system.sigma[tail - 1] > parameters[j])) residual += system.power[--tail];
    curve[j].residual_norm = residual;
  }
  double solution = 0.0;
  double freedom = 0.0;
  std::size_t head = 0;
  for (std::size_t j = parameters.size(); j-- > 0;) {
    for (; head < system.size() && system.sigma[head] > parameters[j]; ++head) {
      solution += system.solution_weight[head] * system.power[head];
      freedom += system.multiplicity[head];
    }
    curve[j].solution_norm = solution;
    curve[j].freedom = freedom;
  }
}

}  // namespace modcal
