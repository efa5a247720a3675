// What a fit makes of a record, and what causes of misfit would add to it.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "libcalib/identifiability/law_followers.hpp"
#include "libcalib/identifiability/misfit_causes.hpp"
#include "libcalib/identifiability/tuning.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal {

/// What the fit makes of a record: force, transfer functions, what rings; and what causes of misfit
/// would add to it (misfit_causes()).
class FittedRecord {
 public:
  FittedRecord(const ProjectedLikelihood& likelihood, const ModelPoint& point)
      : record_(likelihood.record()),
        sensor_(point.sensors),
        modes_(likelihood_modes(point, record_.sample_rate)),
        own_(point.basis.size()),
        per_length_(point.basis.tension / point.basis.length),
        fft_(samples()) {
    std::vector<double> residuals;
    likelihood.evaluate(point, {},
                        {.residuals = &residuals,
                         .force = &force_,
                         .amplitudes = &amplitudes_,
                         .left = &left_,
                         .right = &right_});
    for (std::size_t k = 0; k < record_.bins; ++k) {
      const double root = record_.root_weight[k];
      const Complex e(residuals[2 * k], residuals[2 * k + 1]);
      residual_.push_back(root > 0.0 ? e / root : 0.0);
    }
    chord_right_.assign(record_.bins, per_length_);
    chord_left_.assign(record_.bins, -per_length_);
    for (std::size_t n = 0; n < own_; ++n) {
      motions_.emplace_back(record_.bins);
      for (std::size_t k = 0; k < record_.bins; ++k) {
        const Complex s(0.0, record_.omega[k]), receptance = inverse_denominator(modes_[n], s);
        motions_[n][k] = motion_of(n, k, receptance);
        const Complex chord = 2.0 * per_length_ * s * s * receptance;
        chord_right_[k] += chord;
        chord_left_[k] += modes_[n].even ? -chord : chord;
      }
    }
  }

  // A share of the reactions once more, of a string whose frequencies are δ higher: of every mode
  // q + d, D(δ) d = −(D(δ) − D) q, and what is quasi-static stays. What force and decays of the fit
  // are apart is told badly, their sum q, the motion, well. The spectra are those of a motion that
  // goes on where it began: what d has at t = 0 decays from there.
  MisfitCause polarization(double detuning) const {
    SignalColumn columns[2] = {{numbers(), {}}, {{}, numbers()}};
    for (std::size_t k = 0; k < record_.bins; ++k) {
      const NoisePair ends = fitted(k);
      columns[0].left.set(k, ends.left);
      columns[1].right.set(k, ends.right);
    }
    std::vector<Complex> change(record_.bins);
    const double more = detuning * (2.0 + detuning);
    for (std::size_t n = 0; n < own_; ++n) {
      const LikelihoodMode& mode = modes_[n];
      Complex sum, rate_sum;
      for (std::size_t k = 0; k < record_.bins; ++k) {
        const Complex s(0.0, record_.omega[k]);
        const Complex difference = more * mode.omega_squared + detuning * mode.two_zeta_omega * s;
        const Complex own = mode.omega_squared + s * s + mode.two_zeta_omega * s;
        change[k] = ((1.0 + more) * own / (own + difference) - 1.0) * motions_[n][k];
        sum += change[k];
        rate_sum += s * change[k];
      }
      decay(mode, detuning, sum, rate_sum, change);
      for (std::size_t k = 0; k < record_.bins; ++k) {
        const auto [left, right] = ends(change[k], mode.even, {0.0, record_.omega[k]});
        columns[0].left.set(k, columns[0].left.at(k) + left);
        columns[1].right.set(k, columns[1].right.at(k) + right);
      }
    }
    return {.name = std::string(kPolarization),
            .detail = fmt::format("detuned by {:+.2g} %", 100.0 * detuning),
            .columns = {std::move(columns[0]), std::move(columns[1])},
            .widths = Eigen::Vector2d::Constant(kPolarizationWidth)};
  }

  // Mode by mode D_n q_n = f − 2ω_n² p (t/T − 1/2) q_n: the motion as it is fitted, in the time
  // domain, drives its own change.
  MisfitCause drift() const {
    SignalColumn column{numbers(), numbers()};
    std::vector<Complex> spectrum(fft_.bins());
    std::vector<double> motion(fft_.length());
    for (std::size_t n = 0; n < own_; ++n) {
      const LikelihoodMode& mode = modes_[n];
      std::fill(spectrum.begin(), spectrum.end(), 0.0);
      for (std::size_t k = 0; k < record_.bins; ++k) spectrum[k + 1] = motions_[n][k];
      fft_.inverse(spectrum, motion);
      for (std::size_t j = 0; j < motion.size(); ++j) {
        motion[j] *= static_cast<double>(j) / static_cast<double>(motion.size()) - 0.5;
      }
      fft_.forward(motion, spectrum);
      for (std::size_t k = 0; k < record_.bins; ++k) {
        const Complex s(0.0, record_.omega[k]);
        const Complex change =
            -2.0 * mode.omega_squared * spectrum[k + 1] * inverse_denominator(mode, s);
        const auto [left, right] = ends(change, mode.even, s);
        column.left.set(k, column.left.at(k) + left);
        column.right.set(k, column.right.at(k) + right);
      }
    }
    return {.name = std::string(kDrift), .columns = {std::move(column)}};
  }

  // The end at x = L is on a mode of the body, m (s² + 2ζω_b s + ω_b²) u = −R₂. To first order in
  // 1/m the reactions of a pinned string have those of the chord u x/L more,
  //     c₂ = T/L + (2T/L) Σ s²/D_n,   c₁ = −T/L − (2T/L) Σ (−1)^n s²/D_n;
  // by 1/m and by both parts of what the mode of the body itself still has from before. The poles
  // become s_n (1 − (T/mL)/(s_n² + 2ζω_b s_n + ω_b²)).
  MisfitCause bridge(double frequency, double zeta) const {
    const double omega = 2.0 * std::numbers::pi * frequency;
    const Complex rate(-zeta * omega, omega * std::sqrt(1.0 - zeta * zeta));
    const Complex pole = std::exp(rate / record_.sample_rate);
    MisfitCause cause{.name = std::string(kBridge),
                      .detail = fmt::format("at {:.0f} Hz", frequency),
                      .place = frequency,
                      .modes = Eigen::MatrixXcd(own_, 1)};
    for (std::size_t n = 0; n < own_; ++n) {
      const Complex s(0.0, std::sqrt(modes_[n].omega_squared));
      const Complex body = s * s + 2.0 * zeta * omega * s + omega * omega;
      const double coupling = 2.0 * per_length_ * modes_[n].omega_squared / std::norm(body);
      cause.modes(static_cast<Eigen::Index>(n), 0) = -per_length_ / body;
      cause.coupling = std::max(cause.coupling, coupling);
    }
    // No more than a mode that leaves the law may be off; what the body had before is not known.
    constexpr double kUnknown = std::numeric_limits<double>::infinity();
    cause.widths =
        Eigen::Vector3d(kDeparted / cause.modes.cwiseAbs().maxCoeff(), kUnknown, kUnknown);
    cause.columns.assign(3, {numbers(), numbers()});
    for (std::size_t k = 0; k < record_.bins; ++k) {
      const Complex s(0.0, record_.omega[k]), delay = record_.delay.at(k);
      const Complex sensor = sensor_.response(s);
      const bool taken_out = record_.on_bridge.size() > 0;
      const Complex right = taken_out ? record_.on_bridge.at(k) : fitted(k).right;
      const Complex reaction = right * record_.deviation[1] / sensor;
      const Complex decay = 1.0 / (1.0 - pole * delay);
      const Complex other = 1.0 / (1.0 - std::conj(pole) * delay);
      const Complex moved[] = {-reaction / (s * s + 2.0 * zeta * omega * s + omega * omega),
                               decay + other, Complex(0.0, 1.0) * (decay - other)};
      for (std::size_t i = 0; i < cause.columns.size(); ++i) {
        cause.columns[i].left.set(k, chord_left_[k] * moved[i] / record_.deviation[0]);
        cause.columns[i].right.set(k, chord_right_[k] * moved[i] * sensor / record_.deviation[1]);
      }
    }
    return cause;
  }

  // A sensor that has a mode of its own: of what it senses two shares more.
  MisfitCause resonance(bool right, double frequency, double zeta) const {
    const double omega = 2.0 * std::numbers::pi * frequency;
    MisfitCause cause{
        .name = std::string(kResonance),
        .detail = fmt::format("at x = {}, at {:.0f} Hz", right ? "L" : "0", frequency),
        .place = frequency};
    for (const bool quasistatic : {false, true}) {
      PlanarVector change = numbers();
      for (std::size_t k = 0; k < record_.bins; ++k) {
        const Complex s(0.0, record_.omega[k]), loss = 2.0 * zeta * omega * s;
        const NoisePair both = fitted(k);
        change.set(k, (right ? both.right : both.left) * (quasistatic ? omega * omega : loss) /
                          (s * s + loss + omega * omega));
      }
      cause.columns.push_back(right ? SignalColumn{numbers(), std::move(change)}
                                    : SignalColumn{std::move(change), numbers()});
    }
    return cause;
  }

  MisfitCause nonlinear_sensors() const {
    SignalColumn columns[2] = {{cubed(false), {}}, {{}, cubed(true)}};
    return {.name = std::string(kNonlinear),
            .columns = {std::move(columns[0]), std::move(columns[1])}};
  }

  MisfitCause modes_above() const {
    MisfitCause cause{.name = std::string(kModesAbove)};
    const double top = record_.omega[record_.bins - 1];
    for (const bool right : {false, true}) {
      for (const int power : {0, 2}) {
        PlanarVector change = numbers();
        for (std::size_t k = 0; k < record_.bins; ++k) {
          change.set(k, std::pow(record_.omega[k] / top, power) * force_[k]);
        }
        cause.columns.push_back(right ? SignalColumn{{}, std::move(change)}
                                      : SignalColumn{std::move(change), {}});
      }
    }
    return cause;
  }

 private:
  std::size_t samples() const {
    return static_cast<std::size_t>(
        std::lround(2.0 * std::numbers::pi * record_.sample_rate / record_.spacing));
  }
  PlanarVector numbers() const { return PlanarVector(record_.root_weight.size()); }

  static Complex inverse_denominator(const LikelihoodMode& mode, Complex s) {
    return 1.0 / (mode.omega_squared + s * s + mode.two_zeta_omega * s);
  }
  // Takes from a motion the decay from its state at t = 0, whose sum over the bins is given, and
  // that of its rate: c with 2 Re c and 2 Re c r the state, r the rate of the pole.
  void decay(const LikelihoodMode& mode, double detuning, Complex sum, Complex rate_sum,
             std::vector<Complex>& motion) const {
    const Complex rate = std::log(mode.pole) * (1.0 + detuning) * record_.sample_rate;
    const double per_sample = 1.0 / static_cast<double>(fft_.length());
    const double real = sum.real() * per_sample;
    const Complex amplitude(real,
                            (real * rate.real() - rate_sum.real() * per_sample) / rate.imag());
    const Complex pole = std::exp(rate / record_.sample_rate);
    const Complex whole = amplitude * (1.0 - std::pow(pole, static_cast<double>(fft_.length())));
    for (std::size_t k = 0; k < record_.bins; ++k) {
      const Complex delay = record_.delay.at(k);
      motion[k] -=
          whole / (1.0 - pole * delay) + std::conj(whole) / (1.0 - std::conj(pole) * delay);
    }
  }
  // What a modal contribution is in the whitened records.
  struct Ends {
    Complex left, right;
  };
  Ends ends(Complex motion, bool even, Complex s) const {
    const Complex right = motion * sensor_.response(s) / record_.deviation[1];
    return {-motion / record_.deviation[0], even ? right : -right};
  }
  // Mode n with what rings of it, in bin k.
  Complex motion_of(std::size_t n, std::size_t k, Complex receptance) const {
    const LikelihoodMode& mode = modes_[n];
    const Complex driven = mode.residue * force_[k] * receptance;
    if (n >= amplitudes_.size()) return driven;
    const Complex delay = record_.delay.at(k), amplitude = amplitudes_[n];
    return driven + amplitude / (1.0 - mode.pole * delay) +
           std::conj(amplitude) / (1.0 - std::conj(mode.pole) * delay);
  }
  // The records less their noise, e's share of them.
  NoisePair fitted(std::size_t k) const {
    const NoisePair noise =
        noise_of_residual(record_.noise_at(k), left_[k], right_[k], residual_[k]);
    return {record_.left.at(k) - noise.left, record_.right.at(k) - noise.right};
  }
  // The record of one end less its noise, cubed over its mean square.
  PlanarVector cubed(bool right) const {
    std::vector<Complex> spectrum(fft_.bins());
    for (std::size_t k = 0; k < record_.bins; ++k) {
      const NoisePair ends = fitted(k);
      spectrum[k + 1] = right ? ends.right : ends.left;
    }
    std::vector<double> samples(fft_.length());
    fft_.inverse(spectrum, samples);
    double power = 0.0;
    for (const double y : samples) power += y * y;
    const double mean = power / static_cast<double>(samples.size());
    for (double& y : samples) y *= y * y / mean;
    fft_.forward(samples, spectrum);
    PlanarVector result = numbers();
    for (std::size_t k = 0; k < record_.bins; ++k) result.set(k, spectrum[k + 1]);
    return result;
  }

  const WhitenedRecord& record_;
  const Sensor& sensor_;
  std::vector<LikelihoodMode> modes_;
  std::size_t own_;    // modes that the model states, the first
  double per_length_;  // T/L [N/m]
  RealFft fft_;
  std::vector<Complex> force_, amplitudes_, left_, right_, residual_;
  std::vector<Complex> chord_left_, chord_right_;  // reactions to a displacement of x = L [N/m]
  std::vector<std::vector<Complex>> motions_;  // of every stated mode, what rings of it included
};

}  // namespace modcal
