// What is known of the unknowns before the data.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "libcalib/parameters/string_unknowns.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;
using Kind = ParameterKind;
using Complex = std::complex<double>;

}  // namespace

LinearForm StringUnknowns::form(double offset) const {
  return {.slope = Eigen::VectorXd::Zero(size() + 2), .offset = offset};
}

std::optional<LinearForm> StringUnknowns::coordinate(const ParameterName& name,
                                                     const Eigen::VectorXd& theta) const {
  const ParameterType& type = type_of(name);
  const std::optional<std::size_t> place = free_.find(name.kind, name.index);
  if (!type.at && type.moves == Moves::kFrequencies) {
    const bool f0 = name.kind == Kind::kFundamental;
    LinearForm result = form(law_ && f0 ? std::log(fundamental_) : 0.0);
    result.slope[place ? static_cast<Index>(*place) : size() + (f0 ? 0 : 1)] = 1.0;
    return result;
  }
  if (name.kind == Kind::kDampingPower) {
    if (!place) return std::nullopt;
    LinearForm result = form(std::log(reference_.basis.zeta[1] / reference_.basis.zeta[0]));
    result.slope[static_cast<Index>(*place)] = std::numbers::ln2;
    return result;
  }
  if (place && type.at) {
    LinearForm result = form(type.coordinate(value_of(name, reference_)));
    result.slope[static_cast<Index>(*place)] = 1.0;
    return result;
  }
  if (!type.share) return std::nullopt;
  // What the law moves: ln f_n, ln ζ_n; the factor of the damping by that of ζ_1.
  const std::span<const std::size_t> movers = free_.movers(type.moves, name.index);
  if (movers.empty()) return std::nullopt;
  const bool damping = type.moves == Moves::kDamping;
  const double n = static_cast<double>(name.index + 1);
  LinearForm result =
      form(std::log(damping ? reference_.basis.zeta[name.index]
                            : n * fundamental_ * std::sqrt(1.0 + theta[1] * n * n)));
  for (const std::size_t i : movers) {
    const auto at = static_cast<Index>(i);
    result.slope[at] = free_.share(i, name.index, damping ? 0.0 : theta[1]);
    if (free_[i].kind == Kind::kInharmonicity) result.offset -= result.slope[at] * theta[at];
  }
  return result;
}

StatedPriors::Coordinate StringUnknowns::coordinates(const Eigen::VectorXd& theta) const {
  return [this, &theta](const ParameterName& name) { return coordinate(name, theta); };
}

// ln ζ_n scatters about a curve that is itself known to so much; without a scatter of its own each
// is as far from the stated one as the others.
Eigen::MatrixXd ratio_covariance(const UnknownsOptions& options,
                                 std::span<const std::size_t> modes) {
  const auto count = static_cast<Index>(modes.size());
  const double whole = options.damping_width * options.damping_width;
  const double own = std::isnan(options.damping_scatter)
                         ? whole
                         : options.damping_scatter * options.damping_scatter;
  Eigen::MatrixXd covariance = whole * Eigen::MatrixXd::Identity(count, count);
  for (Index i = 0; i < count && own < whole; ++i) {
    for (Index j = 0; j < i; ++j) {
      const double apart = std::log(static_cast<double>(modes[static_cast<std::size_t>(i)] + 1) /
                                    static_cast<double>(modes[static_cast<std::size_t>(j)] + 1));
      covariance(i, j) = covariance(j, i) = (whole - own) * std::exp(-0.5 * apart * apart);
    }
  }
  return covariance;
}

void StringUnknowns::state_widths(const std::vector<double>& mean,
                                  PriorEquations& equations) const {
  for (std::size_t k = 0; k < knots_; ++k) {
    const Complex at = reference_.sensors.smooth.knots[k];
    const double offsets[] = {at.real(), at.imag()};
    for (Index part = 0; part < 2; ++part) {
      LinearForm number = form(offsets[part]);
      number.slope[knot(k) + part] = 1.0;
      equations.add(number, 0.0, options_.response.width);
    }
  }
  if (!free_.has(Kind::kDampingRatio)) return;
  std::vector<LinearForm> ratios;
  std::vector<double> logarithms;
  std::vector<std::size_t> places;
  for (std::size_t n = 0; n < modes(); ++n) {
    const ParameterName ratio{Kind::kDampingRatio, n};
    if (priors_.has(ratio) || priors_.fixed(ratio)) continue;
    ratios.push_back(*coordinate(ratio, {}));
    logarithms.push_back(std::log(mean[n]));
    places.push_back(n);
  }
  const auto count = static_cast<Index>(ratios.size());
  const Eigen::MatrixXd covariance = ratio_covariance(options_, places);
  equations.add(ratios, Eigen::Map<const Eigen::VectorXd>(logarithms.data(), count), covariance);
}

PriorEquations StringUnknowns::stated(const Eigen::VectorXd& theta) const {
  PriorEquations equations(size());
  priors_.state(coordinates(theta), equations);
  state_widths(reference_.basis.zeta, equations);
  return equations;
}

PriorEquations StringUnknowns::stated(const Eigen::VectorXd& theta, const LawScatter& law) const {
  PriorEquations equations = stated(theta);
  equations.add_scatter(law, log_frequencies());
  hold(equations);
  return equations;
}

QuadraticPrior StringUnknowns::prior(const Eigen::VectorXd& theta) const {
  PriorEquations equations = stated(theta);
  hold(equations);
  return equations.solve();
}

QuadraticPrior StringUnknowns::prior(const Eigen::VectorXd& theta, const LawScatter& law) const {
  return stated(theta, law).solve();
}

PriorMisfit StringUnknowns::prior_misfit(const Eigen::VectorXd& theta) const {
  return misfit_at(theta, PriorEquations(size()));
}

PriorMisfit StringUnknowns::prior_misfit(const Eigen::VectorXd& theta,
                                         const LawScatter& law) const {
  return misfit_at(theta, stated(theta, law));
}

PriorMisfit StringUnknowns::misfit_at(const Eigen::VectorXd& theta,
                                      const PriorEquations& equations) const {
  return worse_of_response(theta, priors_.misfit(coordinates(theta), equations.completed(theta)));
}

PriorMisfit StringUnknowns::worse_of_response(const Eigen::VectorXd& theta,
                                              const PriorMisfit& stated) const {
  PriorMisfit response{.count = 2 * knots_};
  const SmoothResponse& reference = reference_.sensors.smooth;
  for (std::size_t k = 0; k < knots_; ++k) {
    const Complex number = (reference.knots[k] + Complex(theta[knot(k)], theta[knot(k) + 1])) /
                           options_.response.width;
    response.chi2 += std::norm(number);
    const double farthest = std::max(std::abs(number.real()), std::abs(number.imag()));
    if (farthest <= response.deviations) continue;
    response.deviations = farthest;
    response.farthest =
        fmt::format("the response at {:.4g} Hz",
                    static_cast<double>(k) * reference.spacing / (2.0 * std::numbers::pi));
  }
  return response.contradicted() && !stated.contradicted() ? response : stated;
}

void StringUnknowns::hold(PriorEquations& equations) const {
  const Eigen::VectorXd at = start();
  for (Index i = 0; i < size(); ++i) {
    if (held(i)) equations.hold(i, at[i]);
  }
  const Index law = equations.unknowns();
  if (const auto f0 = priors_.fixed({Kind::kFundamental})) equations.hold(law, std::log(*f0));
  if (const auto b = priors_.fixed({Kind::kInharmonicity})) equations.hold(law + 1, *b);
}

Eigen::VectorXd StringUnknowns::log_frequencies() const {
  Eigen::VectorXd result(static_cast<Index>(modes()));
  for (std::size_t n = 0; n < modes(); ++n) {
    result[static_cast<Index>(n)] = std::log(reference_.basis.frequency(n));
  }
  return result;
}

}  // namespace modcal
