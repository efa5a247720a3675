#include "libinverse/joint/joint_inversion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

double power_of(Complex value) { return value.real() * value.real() + value.imag() * value.imag(); }

// Four partial sums, so that additions do not wait for each other.
double square_sum(std::span<const double> samples) {
  double sums[4] = {0.0, 0.0, 0.0, 0.0};
  std::size_t j = 0;
  for (; j + 4 <= samples.size(); j += 4) {
    for (std::size_t i = 0; i < 4; ++i) sums[i] += samples[j + i] * samples[j + i];
  }
  for (; j < samples.size(); ++j) sums[0] += samples[j] * samples[j];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

FrequencyGrid contour_grid(std::size_t samples, double sample_rate, double sigma) {
  FrequencyGrid grid = FrequencyGrid::of_record(samples, sample_rate);
  grid.sigma = sigma;
  return grid;
}

void require_contour(const JointModel& model) {
  MODCAL_REQUIRE(model.sigma >= 0.0 && std::isfinite(model.sigma),
                 "contour at {:g} 1/s: it must be finite and >= 0", model.sigma);
  MODCAL_REQUIRE(model.sigma == 0.0 || model.truncation == Truncation::kShiftedContour,
                 "contour at {:g} 1/s: only the shifted contour leaves the frequency axis",
                 model.sigma);
}

// Sampling shows the real part of the last bin of an even length, and of bin 0.
void keep_what_sampling_shows(std::size_t samples, std::vector<Complex>& transfer) {
  transfer.front() = transfer.front().real();
  if (samples % 2 == 0) transfer.back() = transfer.back().real();
}

}  // namespace

double contour_of(const ModalBasis& basis, double duration, double noise_share) {
  double decay = basis.size() > 0 ? std::numeric_limits<double>::infinity() : 0.0;
  for (std::size_t i = 0; i < basis.size(); ++i) {
    decay = std::min(decay, basis.zeta[i] * basis.omega[i]);
  }
  const double share = std::clamp(noise_share, 1e-12, 1.0);
  const double balanced = -0.5 * (std::log(share) + decay * duration);
  return std::clamp(balanced, 1.0, 4.0) / duration;
}

// Weights of the two sides in every bin.
struct JointInversion::Weights {
  std::array<double, 2> inverse_variance = {0.0, 0.0};
  double mean_variance = 0.0;

  Weights(const ReactionPair& reactions, const SensorNoiseLevel& noise) {
    double sides = 0.0, largest = 0.0;
    for (const auto& reaction : reactions) {
      if (reaction.empty()) continue;
      const double mean_power = square_sum(reaction) / static_cast<double>(reaction.size());
      largest = std::max(largest, std::sqrt(mean_power));
    }
    // Digits of the data: below them no noise level means anything.
    const double floor = std::max(1e-15 * largest, 1e-150);
    for (std::size_t r = 0; r < 2; ++r) {
      if (reactions[r].empty()) continue;
      const double rms = std::max(noise.rms[r], floor);
      inverse_variance[r] = 1.0 / (rms * rms);
      mean_variance += rms * rms;
      sides += 1.0;
    }
    mean_variance /= sides;
  }
};

JointInversion::JointInversion(const ModalBasis& basis, double contact, std::size_t samples,
                               double sample_rate, const JointModel& model, std::size_t points)
    : fft_(samples), sample_rate_(sample_rate), model_(model), curve_(points) {
  require_contour(model);
  const FrequencyGrid grid = contour_grid(samples, sample_rate, model.sigma);
  StringTransfer transfer =
      string_transfer(basis, contact, grid, model.static_remainder, model.bending, model.sensors);
  receptance_ = transfer.receptance;
  mobility_ = std::move(transfer.receptance);
  for (std::size_t k = 0; k < mobility_.size(); ++k) {
    mobility_[k] *= Complex{grid.sigma, grid.omega(k)};
  }
  keep_what_sampling_shows(samples, receptance_);
  keep_what_sampling_shows(samples, mobility_);
  for (std::size_t r = 0; r < 2; ++r) {
    transfer_[r] = std::move(transfer.reaction[r]);
    keep_what_sampling_shows(samples, transfer_[r]);
    for (const Complex value : transfer_[r]) {
      largest_transfer_ = std::max(largest_transfer_, std::abs(value));
    }
  }
  const double density = 2.0 * basis.mass.at(0) / basis.length;
  const double speed = std::sqrt(basis.tension / density);
  arrival_[0] = contact / speed + model.sensors.delay[0];
  arrival_[1] = (basis.length - contact) / speed + model.sensors.delay[1];
  weight_power_ = static_cast<double>(samples);
  if (model.sigma > 0.0) {
    decay_.resize(samples);
    growth_.resize(samples);
    weight_power_ = 0.0;
    for (std::size_t j = 0; j < samples; ++j) {
      const double exponent = model.sigma * static_cast<double>(j) / sample_rate;
      decay_[j] = std::exp(-exponent);
      growth_[j] = std::exp(exponent);
      weight_power_ += decay_[j] * decay_[j];
    }
  }
  grid_ = {.bins = fft_.bins(), .samples = samples, .sample_rate = sample_rate};
  if (model.truncation == Truncation::kTransient) {
    transient_ = TransientFit(basis, grid, sample_rate, model.bending, model.sensors);
  }
}

void JointInversion::require_record(const ReactionPair& reactions,
                                    const SensorNoiseLevel& noise) const {
  MODCAL_REQUIRE(!(reactions[0].empty() && reactions[1].empty()),
                 "no reaction to invert: one side at least is needed");
  for (std::size_t r = 0; r < 2; ++r) {
    MODCAL_REQUIRE(noise.rms[r] >= 0.0 && std::isfinite(noise.rms[r]),
                   "noise level {:g} of reaction {} must be finite and >= 0", noise.rms[r], r + 1);
    if (reactions[r].empty()) continue;
    MODCAL_REQUIRE(reactions[r].size() == samples(),
                   "reaction {} has {} samples, the inversion is prepared for {}", r + 1,
                   reactions[r].size(), samples());
    if (std::isfinite(square_sum(reactions[r]))) continue;
    for (std::size_t j = 0; j < reactions[r].size(); ++j) {
      MODCAL_REQUIRE(std::isfinite(reactions[r][j]),
                     "sample {} of reaction {} is {:g}: cut the record before it or repair it", j,
                     r + 1, reactions[r][j]);
    }
    throw_invalid_input("the square of reaction {} overflows: check the calibration factor", r + 1);
  }
}

double JointInversion::offset_of(std::span<const double> reaction, std::size_t side) const {
  const auto before = std::min(
      static_cast<std::size_t>(std::max(0.0, arrival_[side] * sample_rate_)), reaction.size());
  if (before == 0) return 0.0;
  return std::accumulate(reaction.begin(), reaction.begin() + static_cast<std::ptrdiff_t>(before),
                         0.0) /
         static_cast<double>(before);
}

void JointInversion::transform(const ReactionPair& reactions, OffsetRule rule,
                               JointWorkspace& workspace, JointResult& result) const {
  workspace.weighted.resize(samples());
  for (std::size_t r = 0; r < 2; ++r) {
    result.offset[r] = 0.0;
    workspace.spectrum[r].resize(fft_.bins());
    if (reactions[r].empty()) {
      std::fill(workspace.spectrum[r].begin(), workspace.spectrum[r].end(), Complex{});
      continue;
    }
    const double offset = rule == OffsetRule::kArrival ? offset_of(reactions[r], r) : 0.0;
    result.offset[r] = offset;
    if (decay_.empty()) {
      std::transform(reactions[r].begin(), reactions[r].end(), workspace.weighted.begin(),
                     [offset](double x) { return x - offset; });
    } else {
      std::transform(reactions[r].begin(), reactions[r].end(), decay_.begin(),
                     workspace.weighted.begin(),
                     [offset](double x, double w) { return (x - offset) * w; });
    }
    fft_.forward(workspace.weighted, workspace.spectrum[r]);
    // On the frequency axis bin 0 is the static level, which sensors do not give.
    if (decay_.empty()) workspace.spectrum[r][0] = 0.0;
  }
}

// After it spectrum[0] holds Σ conj(H_r) R_r/v_r.
void JointInversion::combine(const Weights& weights, JointWorkspace& workspace,
                             JointResult& /*result*/) const {
  const std::size_t bins = fft_.bins();
  workspace.gain.resize(bins);
  const double w0 = weights.inverse_variance[0], w1 = weights.inverse_variance[1];
  const Complex* h0 = transfer_[0].data();
  const Complex* h1 = transfer_[1].data();
  Complex* x0 = workspace.spectrum[0].data();
  const Complex* x1 = workspace.spectrum[1].data();
  for (std::size_t k = 0; k < bins; ++k) {
    workspace.gain[k] = w0 * power_of(h0[k]) + w1 * power_of(h1[k]);
    x0[k] = w0 * (std::conj(h0[k]) * x0[k]) + w1 * (std::conj(h1[k]) * x1[k]);
  }
  if (decay_.empty()) workspace.gain[0] = 0.0;
}

void JointInversion::choose_amplitude(const Weights& weights, const JointMethod& method,
                                      JointWorkspace& workspace, JointResult& result) const {
  const std::size_t bins = fft_.bins();
  workspace.variance.resize(bins);
  const bool known = !method.known_variance.empty();
  if (known) {
    MODCAL_REQUIRE(method.known_variance.size() == bins, "{} prior variances for {} bins",
                   method.known_variance.size(), bins);
    std::copy(method.known_variance.begin(), method.known_variance.end(),
              workspace.variance.begin());
  } else {
    method.prior.shape(grid_, workspace.variance);
  }
  EvidenceCurve::Cells& cells = workspace.cells;
  cells.clear();
  const double per_bin = 1.0 / weight_power_;
  for (std::size_t k = decay_.empty() ? 1 : 0; k < bins; ++k) {
    const double q = workspace.gain[k];
    const double multiplicity = bin_multiplicity(k, samples());
    const double power = power_of(workspace.spectrum[0][k]) * per_bin;
    if (!(q > 0.0)) {
      cells.add(0.0, multiplicity, 0.0, 0.0);
      continue;
    }
    const double inverse = 1.0 / q;
    const double reduced = multiplicity * power * inverse;
    cells.add(q * weights.mean_variance * workspace.variance[k], multiplicity, reduced,
              reduced * inverse);
  }
  ChosenParameter& choice = result.identified.choice;
  curve_.trace(cells, choice);
  // Norms of samples: ‖r‖ in units of the mean noise, ‖F‖ by Parseval.
  const double residual_scale = std::sqrt(weights.mean_variance);
  for (CurvePoint& point : choice.curve) point.residual_norm *= residual_scale;
  choice.point.residual_norm *= residual_scale;
  double amplitude = weights.mean_variance / (choice.parameter() * choice.parameter());
  if (known) {
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
  const std::size_t bins = fft_.bins();
  workspace.scratch.resize(bins);
  const double per_bin = 1.0 / weight_power_;
  for (std::int64_t pass = 0; pass < prior.passes(); ++pass) {
    for (std::size_t k = 0; k < bins; ++k) {
      const double p = workspace.variance[k];
      const double posterior = p / (1.0 + workspace.gain[k] * p);
      workspace.variance[k] =
          p == 0.0
              ? 0.0
              : power_of(workspace.spectrum[0][k]) * posterior * posterior * per_bin + posterior;
    }
    prior.learn(grid_, workspace.variance, workspace.scratch);
    limit_band(band_limit, workspace);
  }
}

double JointInversion::write_signal(std::span<const Complex> transfer, bool wanted,
                                    JointWorkspace& workspace, std::vector<double>& signal) const {
  const std::size_t bins = fft_.bins();
  signal.clear();
  if (!wanted) return std::numeric_limits<double>::quiet_NaN();
  workspace.contact.resize(bins);
  double variance = 0.0;
  const std::vector<Complex>& force = workspace.spectrum[0];
  for (std::size_t k = 0; k < bins; ++k) {
    const double multiplicity = bin_multiplicity(k, samples());
    const double gain = transfer.empty() ? 1.0 : power_of(transfer[k]);
    workspace.contact[k] = transfer.empty() ? force[k] : transfer[k] * force[k];
    variance += multiplicity * gain * workspace.variance[k];
  }
  signal.resize(samples());
  fft_.inverse(workspace.contact, signal);
  for (std::size_t j = 0; j < growth_.size(); ++j) signal[j] *= growth_[j];
  return std::sqrt(variance / static_cast<double>(samples()));
}

void JointInversion::apply_posterior(const JointMethod& method, JointWorkspace& workspace,
                                     JointResult& result) const {
  InversionResult& identified = result.identified;
  double kept = 0.0, all = 0.0;
  std::size_t blind = 0;
  for (std::size_t k = 0; k < fft_.bins(); ++k) {
    const double p = workspace.variance[k];
    const double posterior = p / (1.0 + workspace.gain[k] * p);
    const double share = workspace.gain[k] * posterior;
    workspace.variance[k] = posterior;
    workspace.spectrum[0][k] *= posterior;
    if (k == 0 && decay_.empty()) continue;
    const double multiplicity = bin_multiplicity(k, samples());
    kept += multiplicity * share;
    all += multiplicity;
    if (workspace.gain[k] == 0.0) ++blind;
  }
  if (decay_.empty()) workspace.variance[0] = 0.0;
  workspace.spectrum[0].front() = workspace.spectrum[0].front().real();
  if (samples() % 2 == 0) workspace.spectrum[0].back() = workspace.spectrum[0].back().real();
  identified.bins = fft_.bins() - (decay_.empty() ? 1 : 0);
  identified.blind_bins = blind;
  identified.choice.kept_share = all > 0.0 ? kept / all : 0.0;
  identified.force_spectrum.clear();
  if (method.outputs.force_spectrum) {
    identified.force_spectrum.assign(workspace.spectrum[0].begin(), workspace.spectrum[0].end());
  }
  const InversionOutputs& outputs = method.outputs;
  result.deviation.force = write_signal({}, outputs.force, workspace, identified.force);
  result.deviation.displacement =
      write_signal(receptance_, outputs.displacement, workspace, identified.displacement);
  result.deviation.velocity =
      write_signal(mobility_, outputs.velocity, workspace, identified.velocity);
}

void JointInversion::invert(const ReactionPair& reactions, const SensorNoiseLevel& noise,
                            const JointMethod& method, JointWorkspace& workspace,
                            JointResult& result) const {
  require_record(reactions, noise);
  const Weights weights(reactions, noise);
  result.noise_amplitude = std::sqrt(weights.mean_variance);
  const bool from_rest = model_.truncation == Truncation::kShiftedContour;
  transform(reactions, from_rest ? method.offset : OffsetRule::kNone, workspace, result);
  if (model_.truncation == Truncation::kTransient) {
    // The force's amplitude and the decays are found in turn: the first round's amplitude still
    // holds what the decays explain.
    const std::vector<Complex> kept[2] = {workspace.spectrum[0], workspace.spectrum[1]};
    for (int round = 0; round < 2; ++round) {
      combine(weights, workspace, result);
      choose_amplitude(weights, method, workspace, result);
      workspace.learned.assign(workspace.variance.begin(), workspace.variance.end());
      for (double& variance : workspace.learned) variance *= weight_power_;
      for (std::size_t r = 0; r < 2; ++r) workspace.spectrum[r] = kept[r];
      TransientFit::Setting setting;
      setting.prior = workspace.learned;
      std::array<std::span<Complex>, 2> spectra;
      for (std::size_t r = 0; r < 2; ++r) {
        setting.transfer[r] = transfer_[r];
        setting.noise_variance[r] =
            weights.inverse_variance[r] > 0.0 ? weight_power_ / weights.inverse_variance[r] : 0.0;
        spectra[r] = workspace.spectrum[r];
      }
      transient_.subtract(setting, spectra, workspace.transient);
    }
  }
  combine(weights, workspace, result);
  choose_amplitude(weights, method, workspace, result);
  if (method.known_variance.empty()) {
    learn_spectrum(method.prior, method.band_limit, workspace);
  }
  apply_posterior(method, workspace, result);
}

}  // namespace modcal
