#include "libcalib/parameters/stated_priors.hpp"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/base/dense_solvers.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

StatedPriors::Entry entry_of(const ParameterPrior& prior, const ModelPoint& initial) {
  const ParameterName name = require_parameter(prior.parameter, initial.basis.size());
  const ParameterType& type = type_of(name);
  const double mean = std::isnan(prior.mean) ? value_of(name, initial) : prior.mean;
  StatedPriors::Entry entry{name, type.coordinate(mean), prior.deviation / type.slope(mean),
                            prior.parameter};
  if (name.kind == ParameterKind::kDampingFactor) {
    entry.name.kind = ParameterKind::kDampingRatio;
    entry.mean += std::log(initial.basis.zeta[0]);
  }
  if (name.kind == ParameterKind::kDampingPower) {
    const double stated = std::log(initial.basis.zeta[1] / initial.basis.zeta[0]);
    entry.mean = stated + mean * std::numbers::ln2;
    entry.deviation *= std::numbers::ln2;
  }
  return entry;
}

}  // namespace

bool PriorMisfit::contradicted() const {
  // Not "above": a misfit that is no number is no agreement either.
  return count > 0 && !(chi2 < gsl_cdf_chisq_Pinv(0.9973, static_cast<double>(count)));
}

StatedPriors::StatedPriors(const UnknownsOptions& options, const ModelPoint& initial,
                           std::size_t records) {
  const std::size_t modes = initial.basis.size();
  require_priors(options, modes, records, initial.basis.length);
  for (const std::string& text : options.per_record) own_.push_back(*parse_parameter(text));
  const ModelPoint known = with_fixed(initial, options);
  for (const FixedParameter& fixed : options.fixed) {
    const ParameterName name = require_parameter(fixed.parameter, modes);
    // The initial law is that of the frequencies as they are fixed.
    const ModelPoint& of = type_of(name).at ? initial : known;
    fixed_.push_back({name, std::isnan(fixed.value) ? value_of(name, of) : fixed.value});
  }
  for (const ParameterPrior& prior : options.priors) entries_.push_back(entry_of(prior, initial));
  correlation_ = prior_correlation(options);
}

bool StatedPriors::is_own(const ParameterName& name) const {
  return std::any_of(own_.begin(), own_.end(), [&](const ParameterName& own) {
    return own.kind == name.kind && own.index == name.index;
  });
}

std::optional<double> StatedPriors::fixed(const ParameterName& name) const {
  for (const Fixed& fixed : fixed_) {
    if (fixed.name.kind != name.kind || fixed.name.index != name.index) continue;
    if (fixed.name.record == name.record || !is_own(name)) return fixed.value;
  }
  return std::nullopt;
}

StatedPriors::Found StatedPriors::found(const Coordinate& coordinate) const {
  Found result;
  std::vector<double> means, deviations;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    std::optional<LinearForm> form = coordinate(entries_[i].name);
    if (!form) continue;
    result.forms.push_back(std::move(*form));
    result.which.push_back(static_cast<Eigen::Index>(i));
    means.push_back(entries_[i].mean);
    deviations.push_back(entries_[i].deviation);
  }
  using Vector = Eigen::Map<const Eigen::VectorXd>;
  const auto count = static_cast<Eigen::Index>(means.size());
  result.means = Vector(means.data(), count);
  const Vector scale(deviations.data(), count);
  result.covariance =
      scale.asDiagonal() * correlation_(result.which, result.which) * scale.asDiagonal();
  return result;
}

void StatedPriors::state(const Coordinate& coordinate, PriorEquations& equations) const {
  const Found stated = found(coordinate);
  equations.add(stated.forms, stated.means, stated.covariance);
}

PriorMisfit StatedPriors::misfit(const Coordinate& coordinate, const Eigen::VectorXd& z) const {
  const Found stated = found(coordinate);
  PriorMisfit misfit{.count = stated.forms.size()};
  if (stated.forms.empty()) return misfit;
  Eigen::VectorXd residual(stated.means.size());
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    const LinearForm& form = stated.forms[static_cast<std::size_t>(i)];
    residual[i] =
        (form.slope.dot(z) + form.offset - stated.means[i]) / std::sqrt(stated.covariance(i, i));
    if (i > 0 && !(std::abs(residual[i]) > misfit.deviations)) continue;
    misfit.deviations = std::abs(residual[i]);
    misfit.farthest =
        entries_[static_cast<std::size_t>(stated.which[static_cast<std::size_t>(i)])].parameter;
  }
  const Eigen::VectorXd scale = stated.covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * stated.covariance * scale.asDiagonal();
  misfit.chi2 = residual.dot(PositiveSolver(correlation).solve(residual));
  return misfit;
}

template <typename Taken>
StatedPriors StatedPriors::kept(const Taken& taken) const {
  StatedPriors result = *this;
  result.entries_.clear();
  std::vector<Eigen::Index> places;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (!taken(entries_[i].name)) continue;
    result.entries_.push_back(entries_[i]);
    places.push_back(static_cast<Eigen::Index>(i));
  }
  // What is left of a Gaussian: its marginal.
  result.correlation_ = correlation_(places, places).eval();
  return result;
}

StatedPriors StatedPriors::without_frequencies() const {
  return kept([](const ParameterName& name) { return name.kind != ParameterKind::kFrequency; });
}

StatedPriors StatedPriors::fixing(const std::vector<std::size_t>& modes) const {
  StatedPriors all = *this;
  for (const std::size_t n : modes) {
    all.fixed_.push_back({{.kind = ParameterKind::kFrequency, .index = n}});
  }
  return all.kept([&](const ParameterName& name) {
    return name.kind != ParameterKind::kFrequency || !all.fixed(name);
  });
}

StatedPriors StatedPriors::of_record(std::size_t record) const {
  const ParameterName factor{.kind = ParameterKind::kDampingFactor};
  StatedPriors result = kept([&](const ParameterName& name) {
    // The factor of the damping is stated through a ratio.
    const bool ratio = name.kind == ParameterKind::kDampingRatio;
    return name.record == record || !is_own(ratio ? factor : name);
  });
  std::erase_if(result.fixed_, [&](const Fixed& fixed) {
    return fixed.name.record != record && is_own(fixed.name);
  });
  for (Fixed& fixed : result.fixed_) fixed.name.record = 0;
  for (Entry& entry : result.entries_) entry.name.record = 0;
  return result;
}

bool StatedPriors::has(const ParameterName& name) const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Entry& entry) { return entry.name == name; });
}

}  // namespace modcal
