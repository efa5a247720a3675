#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>

#include "libinverse/joint/joint_estimators.hpp"
#include "libinverse/joint/tuning.hpp"

namespace modcal {
namespace {

void warn_of_sides(const JointInversion& inversion, const JointResult& result,
                   std::vector<std::string>& warnings) {
  if (result.misfit > inversion.contradiction()) {
    warnings.push_back(fmt::format(
        "the reactions contradict each other {:.2g} times more than their noise: the model or the "
        "ends of the record limit the estimate, and its error bars are widened",
        std::sqrt(result.misfit)));
  }
  if (result.slow_widening > kWorthAWord) {
    warnings.push_back(fmt::format(
        "the reactions contradict each other below the first mode, {:.4g} Hz: a sensor drifts or "
        "hums, which makes the error bars {:.2g} times as wide; take it out of both reactions by "
        "one high-pass filter below that mode, or record with sensors that hold their level",
        inversion.fundamental(), result.slow_widening));
  }
}

void note_bending(const JointResult& result, std::vector<std::string>& notes) {
  if (result.bending_widening > kWorthAWord) {
    notes.push_back(fmt::format(
        "whether the ends feel the bending of the string, 1 + B n^2 times the tension in mode n, "
        "as a support does that holds it, is not stated: the deviation holds both, which makes it "
        "{:.2g} times as wide; state reaction: support or tension (calibration.reaction, or that "
        "of inversion.estimator: {{type: joint}})",
        result.bending_widening));
  }
}

}  // namespace

std::vector<Estimate> estimate_with(const JointInversion& inversion, const EstimationRecord& record,
                                    const SensorNoiseLevel& noise, const JointMethod& method,
                                    const char* side, const char* label) {
  JointWorkspace workspace;
  JointResult result;
  inversion.invert(record.reactions, noise, method, workspace, result);
  Estimate estimate;
  estimate.band_limit = method.band_limit;
  estimate.force_variance = std::move(result.force_variance);
  estimate.velocity_variance = std::move(result.velocity_variance);
  estimate.force_excess = std::move(result.force_excess);
  estimate.velocity_excess = std::move(result.velocity_excess);
  estimate.side_misfit = std::move(result.side_misfit);
  const bool both = !record.reactions[0].empty() && !record.reactions[1].empty();
  estimate.side = side;
  estimate.label = both                          ? label
                   : record.reactions[0].empty() ? "from R2 (x = L)"
                                                 : "from R1 (x = 0)";
  estimate.result = std::move(result.identified);
  estimate.largest_transfer = inversion.largest_transfer();
  estimate.force_deviation = result.deviation.force;
  estimate.displacement_deviation = result.deviation.displacement;
  estimate.velocity_deviation = result.deviation.velocity;
  const double duration = static_cast<double>(inversion.samples()) / inversion.sample_rate();
  estimate.figures = {{"sigma", inversion.sigma()},
                      {"sigma_T", inversion.sigma() * duration},
                      {"noise_rms_1", noise.rms[0]},
                      {"noise_rms_2", noise.rms[1]},
                      {"noise_share_of_band", noise.noise_share},
                      {"offset_1", result.offset[0]},
                      {"offset_2", result.offset[1]},
                      {"force_deviation", result.deviation.force},
                      {"misfit_of_sides", result.misfit}};
  warn_of_sides(inversion, result, estimate.warnings);
  note_bending(result, estimate.notes);
  if (!both) {
    estimate.warnings.push_back(fmt::format(
        "reaction {} is missing: the estimate rests on the other one alone, and nothing "
        "tells whether the string is the one stated, which the band takes for granted: record both "
        "ends, or check the string on a pluck (kind: identify)",
        record.reactions[0].empty() ? 1 : 2));
  }
  if (!noise.measured) {
    estimate.warnings.emplace_back(
        "the sample rate leaves no band above the modes to measure the noise in: 1 % of each "
        "reaction is supposed: state noise_rms_1 and noise_rms_2 of the estimator, or record at a "
        "higher rate");
  }
  std::string warning = warning_of(estimate.result.choice);
  if (!warning.empty()) estimate.warnings.push_back(std::move(warning));
  return {std::move(estimate)};
}

}  // namespace modcal
