#include "libinverse/joint/joint_inversion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libinverse/joint/joint_kernels.hpp"
#include "libinverse/joint/tuning.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

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

StringTransfer bent_transfer(const ModalBasis& basis, double contact, const FrequencyGrid& grid,
                             std::size_t samples, const JointModel& model) {
  StringSupport support = model.support;
  support.bending = true;
  StringTransfer transfer = string_transfer(basis, contact, grid, support, model.sensors);
  for (std::vector<Complex>& reaction : transfer.reaction) {
    keep_what_sampling_shows(samples, reaction);
  }
  return transfer;
}

// With H for H', that of ends that feel the bending, F is found Σ conj(H_r) H'_r/Σ |H_r|² times as
// large as it is: what it misses is 1 − Σ conj(H'_r) H_r/Σ |H'_r|² of what is found.
std::vector<double> bending_shares(const std::array<std::vector<Complex>, 2>& transfer,
                                   const StringTransfer& bent) {
  std::vector<double> shares(transfer[0].size());
  for (std::size_t k = 0; k < shares.size(); ++k) {
    Complex both{};
    double power = 0.0;
    for (std::size_t r = 0; r < 2; ++r) {
      both += std::conj(bent.reaction[r][k]) * transfer[r][k];
      power += std::norm(bent.reaction[r][k]);
    }
    shares[k] = power > 0.0 ? std::norm(1.0 - both / power) : 0.0;
  }
  return shares;
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

JointInversion::Weights::Weights(const SidePowers& powers, const SensorNoiseLevel& noise) {
  double sides = 0.0;
  const double largest = std::sqrt(std::max(powers[0].mean, powers[1].mean));
  // Digits of the data: below them no noise level means anything.
  const double floor = std::max(1e-15 * largest, 1e-150);
  for (std::size_t r = 0; r < 2; ++r) {
    if (!powers[r].recorded) continue;
    const double rms = std::max(noise.rms[r], floor);
    inverse_variance[r] = 1.0 / (rms * rms);
    mean_variance += rms * rms;
    sides += 1.0;
  }
  mean_variance /= sides;
}

JointInversion::JointInversion(const ModalBasis& basis, double contact, std::size_t samples,
                               double sample_rate, const JointModel& model, std::size_t points)
    : fft_(samples), sample_rate_(sample_rate), model_(model), curve_(points) {
  require_contour(model);
  const FrequencyGrid grid = contour_grid(samples, sample_rate, model.sigma);
  StringTransfer transfer = string_transfer(basis, contact, grid, model.support, model.sensors);
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
  if (model.support.bending_open && inharmonicity_of(basis) > 0.0) {
    bending_share_ = bending_shares(transfer_, bent_transfer(basis, contact, grid, samples, model));
  }
  if (basis.size() > 0) {
    fundamental_ = basis.frequency(0);
    highest_ = basis.frequency(basis.size() - 1);
  }
  arrival_ = first_arrivals(basis, contact, model.sensors);
  weight_power_ = static_cast<double>(samples);
  if (model.sigma > 0.0) {
    decay_.resize(samples);
    growth_.resize(samples);
    weight_power_ = 0.0;
    for (std::size_t j = 0; j < samples; ++j) {
      const double exponent = model.sigma * static_cast<double>(j) / sample_rate;
      decay_[j] = std::exp(-exponent);
      growth_[j] = std::exp(exponent) / static_cast<double>(samples);
      weight_power_ += decay_[j] * decay_[j];
    }
  }
  grid_ = {.bins = fft_.bins(), .samples = samples, .sample_rate = sample_rate};
  if (model.truncation == Truncation::kTransient) {
    transient_ =
        TransientFit(basis, contact, grid, sample_rate, model.support.bending, model.sensors);
  }
}

JointInversion::SidePowers JointInversion::require_record(const ReactionPair& reactions,
                                                          const SensorNoiseLevel& noise) const {
  SidePowers powers;
  MODCAL_REQUIRE(!(reactions[0].empty() && reactions[1].empty()),
                 "no reaction to invert: one side at least is needed");
  for (std::size_t r = 0; r < 2; ++r) {
    MODCAL_REQUIRE(noise.rms[r] >= 0.0 && std::isfinite(noise.rms[r]),
                   "noise level {:g} of reaction {} must be finite and >= 0", noise.rms[r], r + 1);
    if (reactions[r].empty()) continue;
    MODCAL_REQUIRE(reactions[r].size() == samples(),
                   "reaction {} has {} samples, the inversion is prepared for {}", r + 1,
                   reactions[r].size(), samples());
    const double square = square_sum(reactions[r]);
    powers[r] = {.recorded = true, .mean = square / static_cast<double>(samples())};
    if (std::isfinite(square)) continue;
    for (std::size_t j = 0; j < reactions[r].size(); ++j) {
      MODCAL_REQUIRE(std::isfinite(reactions[r][j]),
                     "sample {} of reaction {} is {:g}: cut the record before it or repair it", j,
                     r + 1, reactions[r][j]);
    }
    throw_invalid_input("the square of reaction {} overflows: check the calibration factor", r + 1);
  }
  return powers;
}

double JointInversion::contradiction() const {
  return model_.truncation == Truncation::kTransient ? kUnknownEndsContradict : kSidesContradict;
}

std::size_t JointInversion::samples_before_arrival(std::size_t side) const {
  return std::min(static_cast<std::size_t>(std::max(0.0, arrival_[side] * sample_rate_)),
                  samples());
}

double JointInversion::offset_of(std::span<const double> reaction, std::size_t side) const {
  const std::size_t before = samples_before_arrival(side);
  if (before == 0) return 0.0;
  return std::accumulate(reaction.begin(), reaction.begin() + static_cast<std::ptrdiff_t>(before),
                         0.0) /
         static_cast<double>(before);
}

void JointInversion::transform(const ReactionPair& reactions, OffsetRule rule,
                               JointWorkspace& workspace, JointResult& result) const {
  // On the frequency axis bin 0 is the static level, which sensors give only from rest.
  workspace.level_known = !decay_.empty() || rule == OffsetRule::kArrival;
  for (std::size_t r = 0; r < 2; ++r) {
    result.offset[r] = 0.0;
    workspace.spectrum[r].resize(fft_.bins());
    if (reactions[r].empty()) {
      std::fill(workspace.spectrum[r].begin(), workspace.spectrum[r].end(), Complex{});
      continue;
    }
    const double offset = rule == OffsetRule::kArrival ? offset_of(reactions[r], r) : 0.0;
    result.offset[r] = offset;
    const std::span<double> weighted = fft_.samples_in(workspace.spectrum[r]);
    if (decay_.empty()) {
      std::transform(reactions[r].begin(), reactions[r].end(), weighted.begin(),
                     [offset](double x) { return x - offset; });
    } else {
      std::transform(reactions[r].begin(), reactions[r].end(), decay_.begin(), weighted.begin(),
                     [offset](double x, double w) { return (x - offset) * w; });
    }
    fft_.forward(workspace.spectrum[r]);
    if (!workspace.level_known) workspace.spectrum[r][0] = 0.0;
  }
}

// After it spectrum[0] holds Σ conj(H_r) R_r/v_r.
void JointInversion::combine(const Weights& weights, JointWorkspace& workspace) const {
  workspace.gain.resize(fft_.bins());
  joint_kernels().combine_sides(weights.inverse_variance, transfer_, workspace.spectrum,
                                workspace.gain);
  if (!workspace.level_known) workspace.gain[0] = 0.0;
}

TransientFit::Setting JointInversion::setting_of(const Weights& weights,
                                                 const JointWorkspace& workspace) const {
  TransientFit::Setting setting;
  setting.prior = workspace.learned;
  setting.level_known = workspace.level_known;
  for (std::size_t r = 0; r < 2; ++r) {
    setting.transfer[r] = transfer_[r];
    setting.noise_variance[r] =
        weights.inverse_variance[r] > 0.0 ? weight_power_ / weights.inverse_variance[r] : 0.0;
  }
  return setting;
}

// The force's amplitude and the decays are found in turn: the first round's amplitude still holds
// what the decays explain.
void JointInversion::take_out_decays(const Weights& weights, const JointMethod& method,
                                     JointWorkspace& workspace, JointResult& result) const {
  workspace.recorded = workspace.spectrum;
  for (int round = 0; round < 2; ++round) {
    combine(weights, workspace);
    choose_amplitude(weights, method, workspace, result);
    workspace.learned.assign(workspace.variance.begin(), workspace.variance.end());
    for (double& variance : workspace.learned) variance *= weight_power_;
    workspace.spectrum = workspace.recorded;
    transient_.subtract(setting_of(weights, workspace),
                        {workspace.spectrum[0], workspace.spectrum[1]}, workspace.transient);
  }
}

double JointInversion::ringing_misfit(const ReactionPair& reactions, const SensorNoiseLevel& noise,
                                      std::span<const double> lines,
                                      JointWorkspace& workspace) const {
  if (model_.truncation != Truncation::kTransient) return std::numeric_limits<double>::quiet_NaN();
  const auto top = static_cast<std::size_t>(highest_ / grid_.bin_width());
  double sum = 0.0, sides = 0.0;
  for (std::size_t r = 0; r < 2; ++r) {
    if (reactions[r].empty()) continue;
    ReactionPair alone;
    alone[r] = reactions[r];
    const Weights weights(require_record(alone, noise), noise);
    JointResult result;
    transform(alone, OffsetRule::kNone, workspace, result);
    sum += transient_.ringing_misfit(setting_of(weights, workspace), r, workspace.spectrum[r],
                                     std::min(top + 1, fft_.bins()), lines, workspace.transient);
    sides += 1.0;
  }
  return sum / sides;
}

void JointInversion::invert(const ReactionPair& reactions, const SensorNoiseLevel& noise,
                            const JointMethod& method, JointWorkspace& workspace,
                            JointResult& result) const {
  const Weights weights(require_record(reactions, noise), noise);
  result.noise_amplitude = std::sqrt(weights.mean_variance);
  transform(reactions, method.offset, workspace, result);
  if (model_.truncation == Truncation::kTransient) {
    take_out_decays(weights, method, workspace, result);
  }
  compare_sides(weights, method, workspace, result);
  combine(weights, workspace);
  choose_amplitude(weights, method, workspace, result);
  if (method.known_variance.empty()) {
    learn_spectrum(method.prior, method.band_limit, workspace);
  }
  apply_posterior(weights, method, workspace, result);
}

}  // namespace modcal
