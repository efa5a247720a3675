#include <algorithm>
#include <cmath>

#include "libinverse/joint/joint_inversion.hpp"
#include "libinverse/joint/joint_kernels.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

void JointInversion::set_prior(const JointMethod& method, JointWorkspace& workspace) const {
  workspace.variance.resize(fft_.bins());
  if (method.known_variance.empty()) {
    method.prior.shape(grid_, workspace.variance);
    return;
  }
  MODCAL_REQUIRE(method.known_variance.size() == fft_.bins(), "{} prior variances for {} bins",
                 method.known_variance.size(), fft_.bins());
  std::copy(method.known_variance.begin(), method.known_variance.end(), workspace.variance.begin());
}

// The first bin and the last of an even length are one degree of freedom, all others two.
void JointInversion::fill_cells(const Weights& weights, JointWorkspace& workspace) const {
  const std::size_t bins = fft_.bins();
  workspace.power.resize(bins);
  for (auto& term : workspace.terms) term.resize(bins);
  joint_kernels().scaled_power(workspace.spectrum[0], 1.0 / weight_power_, workspace.power);
  auto &g = workspace.terms[0], &reduced = workspace.terms[1], &solution = workspace.terms[2];
  joint_kernels().evidence_terms(workspace.gain, workspace.variance, workspace.power,
                                 weights.mean_variance, g, reduced, solution);
  EvidenceCurve::Cells& cells = workspace.cells;
  cells.clear();
  const std::size_t end = samples() % 2 == 0 ? bins - 1 : bins;
  const auto add_single = [&](std::size_t k) {
    cells.add(g[k], 1.0, 0.5 * reduced[k], 0.5 * solution[k]);
  };
  if (workspace.level_known) add_single(0);
  if (end < bins && end > 0) add_single(end);
  if (end <= 1) return;
  const auto pairs = [end](const std::vector<double>& values) {
    return std::span(values).subspan(1, end - 1);
  };
  cells.add_pairs(pairs(g), pairs(reduced), pairs(solution));
}

void JointInversion::choose_amplitude(const Weights& weights, const JointMethod& method,
                                      JointWorkspace& workspace, JointResult& result) const {
  set_prior(method, workspace);
  fill_cells(weights, workspace);
  ChosenParameter& choice = result.identified.choice;
  curve_.trace(workspace.cells, choice);
  // Norms of samples: ‖r‖ in units of the mean noise, ‖F‖ by Parseval.
  const double residual_scale = std::sqrt(weights.mean_variance);
  for (CurvePoint& point : choice.curve) point.residual_norm *= residual_scale;
  choice.point.residual_norm *= residual_scale;
  double amplitude = weights.mean_variance / (choice.parameter() * choice.parameter());
  if (!method.known_variance.empty()) {
    amplitude = 1.0;
    choice.status = ChoiceStatus::kGiven;
    choice.explanation.assign("the spectrum of the force is given");
    choice.point.parameter = std::sqrt(weights.mean_variance);
  }
  for (double& variance : workspace.variance) variance *= amplitude;
  limit_band(method.band_limit, workspace);
}

void JointInversion::limit_band(double limit, JointWorkspace& workspace) const {
  if (std::isnan(limit)) return;
  for (std::size_t k = 0; k < workspace.variance.size(); ++k) {
    if (static_cast<double>(k) * grid_.bin_width() > limit) workspace.variance[k] = 0.0;
  }
}

// E|F_k|² given the record, smoothed, is the next prior.
void JointInversion::learn_spectrum(const ForcePrior& prior, double band_limit,
                                    JointWorkspace& workspace) const {
  workspace.scratch.resize(fft_.bins());
  for (std::int64_t pass = 0; pass < prior.passes(); ++pass) {
    joint_kernels().expected_power(workspace.gain, workspace.power, workspace.variance);
    prior.learn(grid_, workspace.variance, workspace.scratch);
    limit_band(band_limit, workspace);
  }
}

// The signal's standard deviation from the sum over all bins of its variance, which counts the
// first bin and the last of an even length twice, and what else the bins between them have.
double JointInversion::deviation_of(double sum, std::span<const Complex> transfer,
                                    std::span<const double> more,
                                    const JointWorkspace& workspace) const {
  const auto variance_at = [&](std::size_t k) {
    return workspace.variance[k] * (transfer.empty() ? 1.0 : std::norm(transfer[k]));
  };
  double variance = 2.0 * sum - variance_at(0);
  const std::size_t last = fft_.bins() - 1;
  if (samples() % 2 == 0 && last > 0) variance -= variance_at(last);
  for (const double value : more) variance += 2.0 * value;
  return std::sqrt(variance / static_cast<double>(samples()));
}

double JointInversion::write_signal(ContactSignal what, bool wanted, JointWorkspace& workspace,
                                    std::vector<double>& signal) const {
  if (!wanted) {
    signal.clear();
    return std::numeric_limits<double>::quiet_NaN();
  }
  const std::span<const Complex> transfer =
      what == ContactSignal::kForce          ? std::span<const Complex>{}
      : what == ContactSignal::kDisplacement ? std::span<const Complex>(receptance_)
                                             : std::span<const Complex>(mobility_);
  double sum = 0.0;
  std::span<Complex> spectrum = workspace.spectrum[0];  // the force comes last
  if (transfer.empty()) {
    for (const double variance : workspace.variance) sum += variance;
  } else {
    workspace.contact.resize(fft_.bins());
    spectrum = workspace.contact;
    sum = joint_kernels().through_transfer(transfer, workspace.spectrum[0], workspace.variance,
                                           spectrum);
    if (model_.truncation == Truncation::kTransient) {
      const bool velocity = what == ContactSignal::kVelocity;
      transient_.add_motion(velocity, velocity || workspace.level_known ? 0 : 1, spectrum,
                            workspace.transient);
    }
  }
  signal.resize(samples());
  fft_.inverse(spectrum);
  const std::span<const double> weighted = fft_.samples_in(spectrum);
  if (growth_.empty()) {
    const double scale = 1.0 / static_cast<double>(samples());
    std::transform(weighted.begin(), weighted.end(), signal.begin(),
                   [scale](double x) { return scale * x; });
  } else {
    std::transform(weighted.begin(), weighted.end(), growth_.begin(), signal.begin(),
                   [](double x, double w) { return x * w; });
  }
  return deviation_of(sum, transfer, workspace.by_decays[static_cast<std::size_t>(what)],
                      workspace);
}

void JointInversion::count_bins(double kept_pairs, JointWorkspace& workspace,
                                InversionResult& identified) const {
  const std::size_t bins = fft_.bins(), last = bins - 1, first = workspace.level_known ? 0 : 1;
  const auto share = [&](std::size_t k) { return workspace.gain[k] * workspace.variance[k]; };
  double kept = 2.0 * kept_pairs - share(0), all = 2.0 * static_cast<double>(bins) - 1.0;
  if (samples() % 2 == 0 && last > 0) {
    kept -= share(last);
    all -= 1.0;
  }
  if (first == 1) all -= 1.0;  // the gain of bin 0 is 0
  identified.bins = bins - first;
  identified.blind_bins = static_cast<std::size_t>(std::count(
      workspace.gain.begin() + static_cast<std::ptrdiff_t>(first), workspace.gain.end(), 0.0));
  identified.choice.kept_share = all > 0.0 ? std::clamp(kept / all, 0.0, 1.0) : 0.0;
}

void JointInversion::find_errors_of_decays(const Weights& weights, const JointMethod& method,
                                           JointWorkspace& workspace) const {
  for (auto& variance : workspace.by_decays) variance.clear();
  if (model_.truncation != Truncation::kTransient || !method.outputs.deviations) return;
  const InversionOutputs& outputs = method.outputs;
  TransientFit::Effect effect{.motion = {receptance_, mobility_},
                              .motion_scale = 1.0 / std::sqrt(weight_power_)};
  const bool wanted[] = {outputs.force || method.variances, outputs.displacement,
                         outputs.velocity || method.variances};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!wanted[i]) continue;
    workspace.by_decays[i].assign(fft_.bins(), 0.0);
    effect.variance[i] = workspace.by_decays[i];
  }
  // F errs by Σ conj(H_r) D_r/v_r over q + 1/P, and the rows have that over √q √(1 + q P).
  workspace.scratch.resize(fft_.bins());
  for (std::size_t k = 0; k < fft_.bins(); ++k) {
    const double gain = workspace.gain[k];
    workspace.scratch[k] = workspace.variance[k] *
                           std::sqrt(gain * (1.0 + gain / weight_power_ * workspace.learned[k]));
  }
  effect.force = workspace.scratch;
  transient_.error_variances(setting_of(weights, workspace),
                             {workspace.recorded[0], workspace.recorded[1]}, effect,
                             workspace.transient);
}

void JointInversion::apply_posterior(const Weights& weights, const JointMethod& method,
                                     JointWorkspace& workspace, JointResult& result) const {
  InversionResult& identified = result.identified;
  std::vector<Complex>& force = workspace.spectrum[0];
  const double kept = joint_kernels().apply_posterior(workspace.gain, workspace.variance, force);
  count_bins(kept, workspace, identified);
  find_errors_of_decays(weights, method, workspace);
  if (method.variances) {
    result.force_variance = workspace.variance;
    result.velocity_variance = workspace.variance;
    for (std::size_t k = 0; k < mobility_.size(); ++k) {
      result.velocity_variance[k] *= std::norm(mobility_[k]);
    }
    for (std::size_t k = 0; k < workspace.by_decays[0].size(); ++k) {
      result.force_variance[k] += workspace.by_decays[0][k];
      result.velocity_variance[k] += workspace.by_decays[2][k];
    }
  }
  widen_by_misfit(method.variances, workspace, result);
  widen_by_bending(workspace, result);
  if (!workspace.level_known) workspace.variance[0] = 0.0;
  force.front() = force.front().real();
  if (samples() % 2 == 0) force.back() = force.back().real();
  identified.force_spectrum.clear();
  if (method.outputs.force_spectrum) {
    identified.force_spectrum.assign(force.begin(), force.end());
  }
  const InversionOutputs& outputs = method.outputs;
  result.deviation.displacement = write_signal(ContactSignal::kDisplacement, outputs.displacement,
                                               workspace, identified.displacement);
  result.deviation.velocity =
      write_signal(ContactSignal::kVelocity, outputs.velocity, workspace, identified.velocity);
  result.deviation.force =
      write_signal(ContactSignal::kForce, outputs.force, workspace, identified.force);
  if (!outputs.deviations) result.deviation = {};
}

}  // namespace modcal
