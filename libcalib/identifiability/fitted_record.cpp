#include "libcalib/identifiability/fitted_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "libcalib/identifiability/law_followers.hpp"
#include "libcalib/identifiability/tuning.hpp"

namespace modcal {

using std::numbers::pi;

FittedRecord::FittedRecord(const ProjectedLikelihood& likelihood, const ModelPoint& point)
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
    read_.push_back(sensor_.response({0.0, record_.omega[k]}));
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
  const bool taken_out = record_.on_bridge.size() > 0;
  for (std::size_t k = 0; k < record_.bins; ++k) {
    const Complex right = taken_out ? record_.on_bridge.at(k) : fitted(k).right;
    reaction_.push_back(right * record_.deviation[1] / read_[k]);
    chord_left_[k] /= record_.deviation[0];
    chord_right_[k] *= read_[k] / record_.deviation[1];
  }
}

MisfitCause FittedRecord::polarization(double detuning) const {
  std::vector<Complex> change(record_.bins);
  Motions moved(record_.bins);
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
    moved.add(change, mode.even);
  }
  SignalColumn columns[2] = {{numbers(), {}}, {{}, numbers()}};
  for (std::size_t k = 0; k < record_.bins; ++k) {
    const NoisePair own = fitted(k), more_of_it = ends(moved, k);
    columns[0].left.set(k, own.left + more_of_it.left);
    columns[1].right.set(k, own.right + more_of_it.right);
  }
  return {.name = std::string(kPolarization),
          .detail = fmt::format("detuned by {:+.2g} %", 100.0 * detuning),
          .columns = {std::move(columns[0]), std::move(columns[1])},
          .widths = Eigen::Vector2d::Constant(kPolarizationWidth)};
}

std::vector<Complex> FittedRecord::modulated(std::span<const Complex> numbers,
                                             const std::function<double(double)>& factor) const {
  std::vector<Complex> spectrum(fft_.bins());
  std::vector<double> samples(fft_.length());
  std::ranges::copy(numbers, spectrum.begin() + 1);
  fft_.inverse(spectrum, samples);
  for (std::size_t j = 0; j < samples.size(); ++j) {
    samples[j] *= factor(static_cast<double>(j) / static_cast<double>(samples.size()));
  }
  fft_.forward(samples, spectrum);
  return {spectrum.begin() + 1, spectrum.begin() + 1 + std::ssize(numbers)};
}

MisfitCause FittedRecord::drift() const {
  Motions moved(record_.bins);
  std::vector<Complex> change(record_.bins);
  for (std::size_t n = 0; n < own_; ++n) {
    const LikelihoodMode& mode = modes_[n];
    const std::vector<Complex> driving =
        modulated(motions_[n], [](double share) { return share - 0.5; });
    for (std::size_t k = 0; k < record_.bins; ++k) {
      const Complex s(0.0, record_.omega[k]);
      change[k] = -2.0 * mode.omega_squared * driving[k] * inverse_denominator(mode, s);
    }
    moved.add(change, mode.even);
  }
  SignalColumn column{numbers(), numbers()};
  for (std::size_t k = 0; k < record_.bins; ++k) {
    const NoisePair both = ends(moved, k);
    column.left.set(k, both.left);
    column.right.set(k, both.right);
  }
  return {.name = std::string(kDrift), .columns = {std::move(column)}};
}

MisfitCause FittedRecord::bridge(double frequency, double zeta) const {
  const double omega = 2.0 * pi * frequency;
  const Complex rate(-zeta * omega, omega * std::sqrt(1.0 - zeta * zeta));
  const Complex pole = std::exp(rate / record_.sample_rate);
  MisfitCause cause{.name = std::string(kBridge),
                    .detail = bridge_detail(frequency, 0.0),
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
  cause.widths = Eigen::Vector3d(kDeparted / cause.modes.cwiseAbs().maxCoeff(), kUnknown, kUnknown);
  cause.columns.assign(3, {numbers(), numbers()});
  for (std::size_t k = 0; k < record_.bins; ++k) {
    const Complex s(0.0, record_.omega[k]), delay = record_.delay.at(k);
    const Complex decay = 1.0 / (1.0 - pole * delay);
    const Complex other = 1.0 / (1.0 - std::conj(pole) * delay);
    const Complex moved[] = {-reaction_[k] / (s * s + 2.0 * zeta * omega * s + omega * omega),
                             decay + other, Complex(0.0, 1.0) * (decay - other)};
    for (std::size_t i = 0; i < cause.columns.size(); ++i) {
      cause.columns[i].left.set(k, chord_left_[k] * moved[i]);
      cause.columns[i].right.set(k, chord_right_[k] * moved[i]);
    }
  }
  return cause;
}

MisfitCause FittedRecord::resonance(bool right, double frequency, double zeta) const {
  const double omega = 2.0 * pi * frequency;
  MisfitCause cause{.name = std::string(kResonance),
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

MisfitCause FittedRecord::nonlinear_sensors() const {
  SignalColumn columns[2] = {{cubed(false), {}}, {{}, cubed(true)}};
  return {.name = std::string(kNonlinear),
          .columns = {std::move(columns[0]), std::move(columns[1])}};
}

std::size_t FittedRecord::samples() const {
  return static_cast<std::size_t>(std::lround(2.0 * pi * record_.sample_rate / record_.spacing));
}

Complex FittedRecord::inverse_denominator(const LikelihoodMode& mode, Complex s) {
  return 1.0 / (mode.omega_squared + s * s + mode.two_zeta_omega * s);
}

void FittedRecord::decay(const LikelihoodMode& mode, double detuning, Complex sum, Complex rate_sum,
                         std::vector<Complex>& motion) const {
  const Complex rate = std::log(mode.pole) * (1.0 + detuning) * record_.sample_rate;
  const double per_sample = 1.0 / static_cast<double>(fft_.length());
  const double real = sum.real() * per_sample;
  const Complex amplitude(real, (real * rate.real() - rate_sum.real() * per_sample) / rate.imag());
  const Complex pole = std::exp(rate / record_.sample_rate);
  const Complex whole = amplitude * (1.0 - std::pow(pole, static_cast<double>(fft_.length())));
  for (std::size_t k = 0; k < record_.bins; ++k) {
    const Complex delay = record_.delay.at(k);
    motion[k] -= whole / (1.0 - pole * delay) + std::conj(whole) / (1.0 - std::conj(pole) * delay);
  }
}

void FittedRecord::Motions::add(const std::vector<Complex>& motion, bool is_even) {
  std::vector<Complex>& sum = is_even ? even : odd;
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += motion[k];
}

NoisePair FittedRecord::ends(const Motions& motions, std::size_t k) const {
  const Complex odd = motions.odd[k], even = motions.even[k];
  return {-(odd + even) / record_.deviation[0], (even - odd) * read_[k] / record_.deviation[1]};
}

Complex FittedRecord::motion_of(std::size_t n, std::size_t k, Complex receptance) const {
  const LikelihoodMode& mode = modes_[n];
  const Complex driven = mode.residue * force_[k] * receptance;
  if (n >= amplitudes_.size()) return driven;
  const Complex delay = record_.delay.at(k), amplitude = amplitudes_[n];
  return driven + amplitude / (1.0 - mode.pole * delay) +
         std::conj(amplitude) / (1.0 - std::conj(mode.pole) * delay);
}

NoisePair FittedRecord::fitted(std::size_t k) const {
  const NoisePair noise = noise_of_residual(record_.noise_at(k), left_[k], right_[k], residual_[k]);
  return {record_.left.at(k) - noise.left, record_.right.at(k) - noise.right};
}

PlanarVector FittedRecord::cubed(bool right) const {
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

}  // namespace modcal
