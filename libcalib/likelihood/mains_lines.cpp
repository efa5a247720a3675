#include "libcalib/likelihood/mains_lines.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "libcalib/likelihood/tuning.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/mains_search.hpp"

namespace modcal {
namespace {

using std::numbers::pi;

std::vector<OwnLine> own_lines(const std::vector<LikelihoodMode>& modes) {
  std::vector<OwnLine> own;
  for (const LikelihoodMode& mode : modes) {
    const double frequency = std::sqrt(mode.omega_squared) / (2.0 * pi);
    own.push_back({.frequency = frequency, .reach = kNearMode * frequency});
  }
  return own;
}

}  // namespace

// (H_2 Y_1 - H_1 Y_2)/|H| under the window is, of a model that is off by a few per cent, little of
// the string's motion below its modes, and all of a hum that does not reach both ends as a force.
std::vector<double> mains_lines(const NoisyRecords& records, const ModelPoint& point,
                                double mains) {
  if (mains == 0.0) return {};
  const std::vector<LikelihoodMode> modes = likelihood_modes(point, records.sample_rate);
  const auto kept = [&modes](double frequency, Complex left, Complex right) {
    const double omega = 2.0 * pi * frequency;
    Complex odd = 0.0, even = 0.0;
    for (const LikelihoodMode& mode : modes) {
      const Complex denominator(mode.omega_squared - omega * omega, mode.two_zeta_omega * omega);
      (mode.even ? even : odd) += mode.residue / denominator;
    }
    const Complex at_left = -(odd + even), at_right = even - odd;
    return std::norm(at_right * left - at_left * right) /
           (std::norm(at_left) + std::norm(at_right));
  };
  return find_mains(records.reactions, records.sample_rate, own_lines(modes), kept, mains);
}

std::vector<double> mains_lines(const ProjectedLikelihood& likelihood, const ModelPoint& point,
                                double mains) {
  if (mains == 0.0) return {};
  const WhitenedRecord& record = likelihood.record();
  std::vector<double> residuals;
  likelihood.evaluate(point, {}, {.residuals = &residuals});
  const RealFft fft(
      static_cast<std::size_t>(std::round(2.0 * pi * record.sample_rate / record.spacing)));
  std::vector<Complex> spectrum(fft.bins());
  for (std::size_t k = 0; k < record.bins; ++k) {
    spectrum[record.first + k] = {residuals[2 * k], residuals[2 * k + 1]};
  }
  const auto all = [](double, Complex residual, Complex) { return std::norm(residual); };
  std::vector<double> left = fft.inverse(std::move(spectrum)), none(left.size());
  const std::vector<LikelihoodMode> modes = likelihood_modes(point, record.sample_rate);
  return find_mains({std::move(left), std::move(none)}, record.sample_rate, own_lines(modes), all,
                    mains);
}

bool same_lines(const std::vector<double>& lines, const NoisyRecords& records) {
  const double least = 0.01 * records.sample_rate / static_cast<double>(records.samples());
  return lines.size() == records.lines.size() &&
         (lines.empty() || std::abs(lines.back() - records.lines.back()) <= least);
}

}  // namespace modcal
