// What is known of the unknowns before the data.
#include <cmath>
#include <numbers>

#include "libcalib/likelihood/string_unknowns.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

}  // namespace

LinearForm StringUnknowns::form(double offset) const {
  return {.slope = Eigen::VectorXd::Zero(size() + 2), .offset = offset};
}

// ln f_n.
std::optional<LinearForm> StringUnknowns::frequency_coordinate(std::size_t mode,
                                                               const Eigen::VectorXd& theta) const {
  const auto i = static_cast<Index>(mode);
  if (!law_) {
    LinearForm result = form(std::log(reference_.basis.frequency(mode)));
    result.slope[i] = 1.0;
    return result;
  }
  const double n = static_cast<double>(mode + 1);
  const double stiff = 1.0 + theta[1] * n * n;
  LinearForm result = form(std::log(n * fundamental_ * std::sqrt(stiff)));
  result.slope[0] = 1.0;
  result.slope[1] = 0.5 * n * n / stiff;
  result.offset -= result.slope[1] * theta[1];
  return result;
}

// ln ζ_n.
std::optional<LinearForm> StringUnknowns::damping_coordinate(std::size_t mode) const {
  LinearForm result = form(std::log(reference_.basis.zeta[mode]));
  switch (damping_kind()) {
    case Damping::kFixed:
      return std::nullopt;
    case Damping::kPower:
      result.slope[damping() + 1] = std::log(static_cast<double>(mode + 1));
      [[fallthrough]];
    case Damping::kFactor:
      result.slope[damping()] = 1.0;
      break;
    case Damping::kEach:
      result.slope[damping() + static_cast<Index>(mode)] = 1.0;
      break;
  }
  return result;
}

std::optional<LinearForm> StringUnknowns::coordinate(const UnknownName& name,
                                                     const Eigen::VectorXd& theta) const {
  const auto with_slope = [this](Index place, double offset) {
    LinearForm result = form(offset);
    result.slope[place] = 1.0;
    return result;
  };
  const auto of_sensor = [&](std::size_t which, double offset) {
    const Index place = sensor(which);
    return place < 0 ? std::optional<LinearForm>() : with_slope(place, offset);
  };
  switch (name.kind) {
    case UnknownKind::kFundamental:
      return law_ ? with_slope(0, std::log(fundamental_)) : with_slope(size(), 0.0);
    case UnknownKind::kInharmonicity:
      return with_slope(law_ ? 1 : size() + 1, 0.0);
    case UnknownKind::kContact:
      return with_slope(contact(), reference_.contact);
    case UnknownKind::kFrequency:
      return frequency_coordinate(name.mode, theta);
    case UnknownKind::kDampingFactor:
    case UnknownKind::kDampingRatio:
      return damping_coordinate(name.mode);
    case UnknownKind::kDampingPower: {
      if (damping_kind() != Damping::kPower) return std::nullopt;
      LinearForm result = form(std::log(reference_.basis.zeta[1] / reference_.basis.zeta[0]));
      result.slope[damping() + 1] = std::numbers::ln2;
      return result;
    }
    case UnknownKind::kGain:
      return of_sensor(0, std::log(reference_.sensors.gain));
    case UnknownKind::kDelay:
      return of_sensor(1, reference_.sensors.delay);
    case UnknownKind::kCorner:
      return of_sensor(2, reference_.sensors.corner);
  }
  return std::nullopt;
}

void StringUnknowns::state_damping_ratios(const std::vector<double>& mean,
                                          PriorEquations& equations) const {
  if (damping_kind() != Damping::kEach) return;
  for (std::size_t n = 0; n < modes(); ++n) {
    if (priors_.has({.kind = UnknownKind::kDampingRatio, .mode = n})) continue;
    if (priors_.held().ratio(n)) continue;
    equations.add(*damping_coordinate(n), std::log(mean[n]), options_.damping_width);
  }
}

PriorEquations StringUnknowns::stated(const Eigen::VectorXd& theta) const {
  PriorEquations equations(size());
  priors_.state([&](const UnknownName& name) { return coordinate(name, theta); }, equations);
  state_damping_ratios(reference_.basis.zeta, equations);
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

PriorMisfit StringUnknowns::misfit_at(const Eigen::VectorXd& theta,
                                      const PriorEquations& equations) const {
  return priors_.misfit([&](const UnknownName& name) { return coordinate(name, theta); },
                        equations.completed(theta));
}

PriorMisfit StringUnknowns::prior_misfit(const Eigen::VectorXd& theta) const {
  return misfit_at(theta, PriorEquations(size()));
}

PriorMisfit StringUnknowns::prior_misfit(const Eigen::VectorXd& theta,
                                         const LawScatter& law) const {
  return misfit_at(theta, stated(theta, law));
}

StringUnknowns StringUnknowns::under(StatedPriors priors) const {
  StringUnknowns result = *this;
  result.priors_ = std::move(priors);
  return result;
}

void StringUnknowns::hold(PriorEquations& equations) const {
  const Eigen::VectorXd at = start();
  for (Index i = 0; i < size(); ++i) {
    if (held(i)) equations.hold(i, at[i]);
  }
  const HeldParameters& held = priors_.held();
  const Index law = equations.unknowns();
  if (held.fundamental) equations.hold(law, std::log(*held.fundamental));
  if (held.inharmonicity) equations.hold(law + 1, *held.inharmonicity);
}

Eigen::VectorXd StringUnknowns::log_frequencies() const {
  Eigen::VectorXd result(static_cast<Index>(modes()));
  for (std::size_t n = 0; n < modes(); ++n) {
    result[static_cast<Index>(n)] = std::log(reference_.basis.frequency(n));
  }
  return result;
}

Eigen::MatrixXd law_prior(const Eigen::VectorXd& widths, double inharmonicity) {
  PriorEquations equations(widths.size());
  equations.add_scatter({widths, inharmonicity}, Eigen::VectorXd::Zero(widths.size()));
  return equations.solve().precision;
}

}  // namespace modcal
