#include "libcalib/likelihood/projected_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/likelihood/likelihood_evaluation.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

std::vector<LikelihoodMode> likelihood_modes(const ModelPoint& point, double sample_rate) {
  const ModalBasis& basis = point.basis;
  const double wave = std::numbers::pi / basis.length;
  const std::vector<double> shape = basis.shape_at(point.contact);
  std::vector<LikelihoodMode> modes(basis.size());
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const double n = static_cast<double>(i + 1);
    const double omega = basis.omega[i];
    const double zeta = basis.zeta[i];
    MODCAL_REQUIRE(zeta > 0.0 && zeta < 1.0,
                   "damping ratio {:g} of mode {}: the likelihood needs 0 < zeta < 1", zeta, i + 1);
    MODCAL_REQUIRE(omega > 0.0 && omega < std::numbers::pi * sample_rate,
                   "mode {} at {:g} Hz lies above the Nyquist frequency {:g} Hz: use fewer modes",
                   i + 1, basis.frequency(i), 0.5 * sample_rate);
    const double gain = basis.tension * n * wave / basis.mass[i];
    const double root = std::sqrt(1.0 - zeta * zeta);
    const Complex rate(-zeta * omega, omega * root);
    LikelihoodMode& mode = modes[i];
    mode.even = i % 2 == 1;
    mode.residue = gain * shape[i];
    mode.residue_slope = gain * n * wave * std::cos(n * wave * point.contact);
    mode.omega_squared = omega * omega;
    mode.two_zeta_omega = 2.0 * zeta * omega;
    mode.pole = std::exp(rate / sample_rate);
    mode.pole_by_frequency = mode.pole * rate / sample_rate;
    mode.pole_by_damping =
        mode.pole * Complex(-zeta * omega, -omega * zeta * zeta / root) / sample_rate;
  }
  if (!point.higher) return modes;
  for (std::size_t i = 0; point.higher->bending && i < modes.size(); ++i) {
    const double square = static_cast<double>((i + 1) * (i + 1));
    const double stiff = 1.0 + std::max(point.higher->inharmonicity, 0.0) * square;
    modes[i].residue_by_stiffness = modes[i].residue * square;
    modes[i].residue *= stiff;
    modes[i].residue_slope *= stiff;
  }
  for (std::size_t i = point.higher->ringing; i < modes.size(); ++i) modes[i].decays = false;
  for (const HigherMode& higher : higher_modes(*point.higher, basis, point.contact)) {
    modes.push_back({.even = higher.even,
                     .residue = higher.residue,
                     .residue_slope = higher.by_contact,
                     .omega_squared = higher.omega * higher.omega,
                     .residue_by_stiffness = higher.by_inharmonicity,
                     .decays = false,
                     .pole = {},
                     .pole_by_frequency = {},
                     .pole_by_damping = {}});
  }
  return modes;
}

ProjectedLikelihood::ProjectedLikelihood(WhitenedRecord record) : record_(std::move(record)) {}

void ProjectedLikelihood::set_weights(std::span<const double> weights) {
  MODCAL_REQUIRE(weights.size() == record_.bins, "{} weights for {} bins", weights.size(),
                 record_.bins);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    MODCAL_REQUIRE(weights[k] >= 0.0 && weights[k] <= 1.0, "weight {:g} must lie in [0, 1]",
                   weights[k]);
    record_.root_weight[k] = std::sqrt(weights[k]);
  }
}

double ProjectedLikelihood::degrees_of_freedom(std::size_t parameters,
                                               const ModelPoint& point) const {
  const std::size_t plain = plain_transients(record_, point).size();
  const std::size_t ringing =
      std::min(point.basis.size(), point.higher ? point.higher->ringing : point.basis.size());
  const std::size_t projected = plain + (record_.sigma == 0.0 ? 2 * ringing : 0);
  return 2.0 * static_cast<double>(record_.bins) - static_cast<double>(projected + parameters);
}

double ProjectedLikelihood::cost(const ModelPoint& point) const {
  return slope(point, LikelihoodColumns{}).cost;
}

LikelihoodPoint ProjectedLikelihood::slope(const ModelPoint& point,
                                           const LikelihoodColumns& columns) const {
  return LikelihoodEvaluation(record_, point).slope(columns);
}

LikelihoodPoint ProjectedLikelihood::rows(const ModelPoint& point, const LikelihoodColumns& columns,
                                          std::span<const std::size_t> wanted) const {
  if (wanted.empty()) {
    LikelihoodPoint none = slope(point, columns);
    none.information.resize(0, static_cast<Eigen::Index>(columns.count));
    return none;
  }
  if (!LikelihoodEvaluation::may_give_rows(columns, wanted)) return evaluate(point, columns);
  return LikelihoodEvaluation(record_, point).rows(columns, wanted);
}

LikelihoodPoint ProjectedLikelihood::evaluate(const ModelPoint& point,
                                              const LikelihoodColumns& columns,
                                              const Outputs& outputs) const {
  return LikelihoodEvaluation(record_, point).differentiate(columns, outputs);
}

Eigen::MatrixXd ProjectedLikelihood::noise_information(const ModelPoint& point,
                                                       const LikelihoodColumns& columns,
                                                       std::size_t repeats) const {
  WhitenedRecord noise = record_.noise(0);
  LikelihoodEvaluation evaluation(noise, point);
  Eigen::MatrixXd sum = evaluation.differentiate(columns, {}).information;
  for (std::size_t r = 1; r < repeats; ++r) {
    noise.draw_noise(r);
    evaluation.take(noise);
    sum += evaluation.differentiate(columns, {}).information;
  }
  return sum / static_cast<double>(repeats);
}

}  // namespace modcal
