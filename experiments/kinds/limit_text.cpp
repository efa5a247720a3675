#include <fmt/format.h>

#include <cmath>

#include "experiments/kinds/calibration_limit_experiment.hpp"
#include "experiments/kinds/limit_source.hpp"
#include "libcalib/likelihood/expected_limit.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

ExpectedLimit limit_at(const LimitQuestion& question, double contact, TruthCache& truths) {
  ObservationOptions observation = question.observation;
  observation.truth.scene.bow.position = contact;
  const LimitTruth truth = limit_truth(observation, question.noise_level, truths);
  return expected_limit(truth.point, truth.records, question.highest_frequency, question.law_width);
}

std::string law_lines(const ExpectedLimit& limit) {
  constexpr const char* kNames[] = {"f0", "B", "x_c", "damping"};
  constexpr const char* kUnits[] = {"Hz", "", "m", "(factor)"};
  std::string text =
      "stiff-string law, all modes on it (in brackets: what an unknown force leaves):\n";
  for (std::size_t i = 0; i < 4; ++i) {
    text += fmt::format("  {:<8} sd {:.3g} ({:.3g}) {:<9} correlations", kNames[i], limit.law[i],
                        limit.law_attainable[i], kUnits[i]);
    for (std::size_t j = 0; j < i; ++j) {
      text += fmt::format(" {} {:+.2f}", kNames[j], limit.law_correlation[i][j]);
    }
    text += "\n";
  }
  return text;
}

std::string singular_values(const ExpectedLimit& limit) {
  std::string text = "singular values of the frequencies' information:";
  for (std::size_t i = 0; i < limit.singular_values.size(); ++i) {
    text += fmt::format("{}{:<9.3g}", i % 10 == 0 ? "\n  " : " ", limit.singular_values[i]);
  }
  return text + "\n";
}

std::string mode_lines(const ExpectedLimit& limit) {
  std::string text = fmt::format(
      "every frequency free: sd of x_c {:.3g} m, of the damping factor {:.3g}\n{}"
      "  n  f [Hz]      relative sd  verdict\n",
      limit.contact, limit.damping, singular_values(limit));
  for (std::size_t n = 0; n < limit.modes.size(); ++n) {
    const ModeVerdict& mode = limit.modes[n];
    text += fmt::format("{:>3}  {:<10.3f}  {:<11.2e}  {}", n + 1, mode.frequency, mode.deviation,
                        name_of(mode.source));
    if (mode.reason != WeakReason::kNone) text += fmt::format(" ({})", name_of(mode.reason));
    text += "\n";
  }
  return text;
}

std::string proposals(const LimitQuestion& question, const ExpectedLimit& limit,
                      const ModelPoint& point, TruthCache& truths) {
  if (limit.blind_modes == 0) return "no mode is blind at this contact point\n";
  std::string text =
      fmt::format("{} modes are not identified; contact points nearby:\n", limit.blind_modes);
  bool any = false;
  for (const double contact :
       contacts_without_blind_modes(point, 0.02 * point.basis.length, 0.1, 4)) {
    try {
      const ExpectedLimit there = limit_at(question, contact, truths);
      if (there.blind_modes >= limit.blind_modes) continue;
      text += fmt::format("  x_c = {:.5g} m (L/{:.2f}): {} not identified, sd of x_c {:.3g} m\n",
                          contact, point.basis.length / contact, there.blind_modes, there.contact);
      any = true;
    } catch (const InvalidInput& error) {
      text += fmt::format("  x_c = {:.5g} m: cannot be simulated ({})\n", contact, error.what());
    }
  }
  if (!any) text += "  none within 2 % of the length is better: less noise is what helps\n";
  return text;
}

}  // namespace

LimitTruth limit_truth(const ObservationOptions& observation, double noise_level,
                       TruthCache& truths, bool force) {
  MODCAL_REQUIRE(observation.has_scene,
                 "a limit is computed from a simulated truth: state a scene, not a record");
  const double rate = observation.measurement.sample_rate;
  const auto truth = truths.get(observation.truth, rate,
                                {.force = force, .left_reaction = true, .right_reaction = true});
  LimitTruth result{.point = {truth->basis, truth->contact}, .simulated = truth};
  result.records.sample_rate = rate;
  result.records.reactions = {truth->simulation.left_reaction.samples,
                              truth->simulation.right_reaction.samples};
  for (std::size_t r = 0; r < 2; ++r) {
    remove_mean(result.records.reactions[r]);
    result.records.deviation[r] =
        noise_level > 0.0 ? noise_level * standard_deviation(result.records.reactions[r])
                          : noise_deviation(result.records.reactions[r]);
  }
  return result;
}

std::string limit_text(const LimitQuestion& question, TruthCache& truths) {
  MODCAL_REQUIRE(question.noise_level > 0.0,
                 "without noise there is no limit: state a noise level > 0");
  const LimitTruth truth = limit_truth(question.observation, question.noise_level, truths);
  const ExpectedLimit limit =
      expected_limit(truth.point, truth.records, question.highest_frequency, question.law_width);
  return fmt::format("noise {:g} % of each reaction, {:g} s at {:g} Hz, x_c = {:g} m\n",
                     100.0 * question.noise_level,
                     static_cast<double>(truth.records.samples()) / truth.records.sample_rate,
                     truth.records.sample_rate, truth.point.contact) +
         law_lines(limit) + mode_lines(limit) + proposals(question, limit, truth.point, truths);
}

}  // namespace modcal
