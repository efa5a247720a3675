#include "libinverse/observer/result_judgement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libsim/signal/statistics.hpp"

namespace modcal::observer {
namespace {

constexpr std::array kEnds = {End::kLeft, End::kRight};

}  // namespace

void judge_misfit(const ObservedRecord& record, const GainSchedule& schedule,
                  std::span<const double> quiet_misfit, ModelBasedResult& result) {
  double quiet = 0.0, level = 0.0, relative = 0.0;
  for (const std::size_t gain : schedule) quiet += quiet_misfit[gain];
  for (int r = 0; r < 2; ++r) {
    const double share = record.raw_noise[r] / record.noise[r];
    level += 0.5 * share * share;
    relative += 0.25 * record.noise_deviation[r] * record.noise_deviation[r];
  }
  result.expected_misfit = level * quiet / static_cast<double>(schedule.size());
  const double samples = 2.0 * static_cast<double>(record.samples());
  result.misfit_deviation =
      result.expected_misfit * std::sqrt(relative + std::numbers::pi / samples);
}

StaticRecovery static_recovery(const ObservedRecord& record, const ModelBasedResult& result) {
  const double xi = record.contact / record.basis.length;
  const double share[2] = {1.0 - xi, xi};
  double precision = 0.0;
  for (int r = 0; r < 2; ++r) {
    const double weight =
        share[r] / silent_deviation(record, kEnds[r], result.parameters.bow_velocity);
    precision += weight * weight;
  }
  return {mean(result.force), 1.0 / std::sqrt(precision)};
}

void add_warnings(const ModelBasedOptions& options, const ObservedRecord& record,
                  std::span<const double> offset_deviation, ModelBasedResult& result) {
  // Below the floor under the noise the observer's own discretization is all there is to see.
  const double calibrated = std::max(1.0, result.expected_misfit) + 4.0 * result.misfit_deviation;
  const double limit = std::isnan(options.misfit_limit) ? calibrated : options.misfit_limit;
  if (!(result.steady_misfit <= limit)) {
    result.warnings.push_back(fmt::format(
        "innovation misfit {:.4g} (median over blocks) is above {:.4g}, a right model leaves "
        "{:.3f} ± {:.3f}: the model does not explain the reactions to their noise; compare with "
        "the linear estimate, and free what may differ (force_knots, velocity_knots, laws, "
        "delay, "
        "gain, contact, frequencies)",
        result.steady_misfit, limit, result.expected_misfit, result.misfit_deviation));
  }
  for (int r = 0; r < 2; ++r) {
    const double level = std::abs(mean(std::span(record.reaction[r]).first(record.silent[r])) -
                                  result.parameters.offset[r]);
    const double deviation = std::max(
        offset_deviation[r], silent_deviation(record, kEnds[r], result.parameters.bow_velocity));
    if (level > 5.0 * deviation) {
      result.warnings.push_back(fmt::format(
          "the fitted offset of the reaction at {} is {:.3g} N away from its level before the "
          "first wave, {:.2g} standard deviations: the record may not start at rest",
          r == 0 ? "x = 0" : "x = L", level, level / deviation));
    }
  }
}

}  // namespace modcal::observer
