// A string driven by a known force from rest, without a simulator: the response at K samples of a
// force of K samples is taken from a record four times as long on its own contour, where what
// wraps is below 1e-13.
#pragma once

#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "libinverse/joint/force_prior.hpp"
#include "libinverse/joint/joint_estimators.hpp"
#include "libinverse/joint/joint_inversion.hpp"
#include "libsim/base/random.hpp"
#include "libsim/model/damping.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

inline constexpr double kRate = 51200.0;
inline constexpr double kPosition = 0.03;

inline ModalBasis violin_g(double damping = 1e-3) {
  StringModel string;
  string.length = 0.33;
  string.linear_density = 3.1e-3;
  string.fundamental = 196.0;
  string.damping = Choice<DampingLaw>::of<ConstantDamping>("constant", {.ratio = damping});
  return make_modal_basis(string);
}

struct DrivenString {
  std::vector<double> force;
  std::vector<double> reaction[2];
  std::vector<double> displacement;
  std::vector<double> velocity;
  ReactionPair pair() const { return {reaction[0], reaction[1]}; }
};

inline std::vector<double> normal_draw(std::size_t length, const StreamKey& key) {
  std::vector<double> samples(length);
  fill_standard_normal(key, samples);
  return samples;
}

/// A first-order autoregressive force of unit increments above 50 Hz: what JumpPrior supposes.
inline std::vector<double> jumping_force(std::size_t length, const StreamKey& key) {
  const std::vector<double> draw = normal_draw(length, key);
  // 1/(sin² + s²) is the spectrum of x_j = a x_{j−1} + e_j with (1 − a)² = 4 a s².
  const double s = std::sin(std::numbers::pi * 50.0 / kRate);
  const double b = 1.0 + 2.0 * s * s;
  const double a = b - std::sqrt(b * b - 1.0);
  std::vector<double> force(length);
  double value = draw[0] / std::sqrt(1.0 - a * a);
  for (std::size_t j = 0; j < length; ++j) {
    if (j > 0) value = a * value + draw[j];
    force[j] = 0.01 * value;
  }
  return force;
}

inline DrivenString drive(const ModalBasis& basis, double contact, std::vector<double> force,
                          const SensorPair& sensors = {}, bool remainder = false,
                          bool bending = false) {
  const std::size_t samples = force.size();
  const std::size_t padded = 4 * samples;
  FrequencyGrid grid = FrequencyGrid::of_record(padded, kRate);
  grid.sigma = 32.0 * kRate / static_cast<double>(padded);
  const StringTransfer transfer =
      string_transfer(basis, contact, grid, {remainder, bending}, sensors);
  const auto weight = [&](std::size_t j) {
    return std::exp(-grid.sigma * static_cast<double>(j) / kRate);
  };
  std::vector<double> weighted(padded);
  for (std::size_t j = 0; j < samples; ++j) weighted[j] = force[j] * weight(j);
  const RealFft fft(padded);
  const std::vector<Complex> spectrum = fft.forward(weighted);
  const auto respond = [&](const std::vector<Complex>& h, bool derivative) {
    std::vector<Complex> product(spectrum.size());
    for (std::size_t k = 0; k < product.size(); ++k) {
      product[k] = h[k] * spectrum[k];
      if (derivative) product[k] *= Complex{grid.sigma, grid.omega(k)};
    }
    std::vector<double> signal = fft.inverse(std::move(product));
    signal.resize(samples);
    for (std::size_t j = 0; j < samples; ++j) signal[j] /= weight(j);
    return signal;
  };
  DrivenString result;
  for (std::size_t r = 0; r < 2; ++r) result.reaction[r] = respond(transfer.reaction[r], false);
  result.displacement = respond(transfer.receptance, false);
  result.velocity = respond(transfer.receptance, true);
  result.force = std::move(force);
  return result;
}

inline void add_noise(DrivenString& string, double level, const StreamKey& key,
                      SensorNoiseLevel* truth = nullptr) {
  for (std::size_t r = 0; r < 2; ++r) {
    const double rms = level * standard_deviation(string.reaction[r]);
    const std::vector<double> draw =
        normal_draw(string.reaction[r].size(), key.with(static_cast<std::uint64_t>(r)));
    for (std::size_t j = 0; j < draw.size(); ++j) string.reaction[r][j] += rms * draw[j];
    if (truth) truth->rms[r] = rms;
  }
}

inline const JumpPrior kJumps{JumpPrior::Options{}};
inline const LearnedPrior kLearned{LearnedPrior::Options{}};
inline constexpr InversionOutputs kEverything = {
    .force = true, .displacement = true, .velocity = true, .force_spectrum = true};

inline JointModel contour_at(double sigma_t, std::size_t samples) {
  return {.sigma = sigma_t * kRate / static_cast<double>(samples)};
}

inline JointMethod method_with(const ForcePrior& prior, const InversionOutputs& outputs = {}) {
  return {.prior = prior, .offset = OffsetRule::kNone, .outputs = outputs};
}

inline JointResult invert(const JointInversion& inversion, const ReactionPair& reactions,
                          const SensorNoiseLevel& noise, const JointMethod& method) {
  JointWorkspace workspace;
  JointResult result;
  inversion.invert(reactions, noise, method, workspace, result);
  return result;
}

/// The long force without the first and last eighth, where a short record knows least.
inline double middle_error(std::span<const double> x, std::span<const double> y) {
  const std::size_t edge = y.size() / 8;
  return relative_rms_error(x.subspan(edge, y.size() - 2 * edge),
                            y.subspan(edge, y.size() - 2 * edge));
}

inline Estimate estimate_with(const JointOptions& joint, const ModalBasis& basis,
                              const ReactionPair& reactions, bool recorded = false,
                              std::optional<bool> bending = {}) {
  const std::size_t samples = std::max(reactions[0].size(), reactions[1].size());
  JointEstimator::Options options;
  options.joint = joint;
  const auto prepared =
      JointEstimator(options).prepare({basis, kPosition, samples, kRate, recorded, bending});
  const auto regularizer = Choice<Regularizer>("none").make();
  const auto rule = Choice<ParameterChoice>("gcv").make();
  EstimationRecord record;
  record.reactions = reactions;
  return prepared->estimate(record, {*regularizer, *rule, kEverything}).front();
}

inline double figure(const Estimate& estimate, const std::string& name) {
  const std::map<std::string, double> figures(estimate.figures.begin(), estimate.figures.end());
  return figures.at(name);
}

}  // namespace modcal
