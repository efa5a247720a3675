#include "libcalib/parameters/stated_priors.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/likelihood/string_unknowns.hpp"
#include "libcalib/parameters/stiff_string_fit.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using std::numbers::pi;

StiffStringFit law_of(const ModalBasis& basis) {
  std::vector<double> frequencies;
  for (std::size_t n = 0; n < basis.size(); ++n) frequencies.push_back(basis.frequency(n));
  return fit_stiff_string(frequencies);
}

double initial_value(const UnknownName& name, const ModelPoint& initial) {
  switch (name.kind) {
    case UnknownKind::kFundamental:
    case UnknownKind::kInharmonicity: {
      const StiffStringFit law = law_of(initial.basis);
      return name.kind == UnknownKind::kFundamental ? law.fundamental : law.inharmonicity;
    }
    case UnknownKind::kContact:
      return initial.contact;
    case UnknownKind::kFrequency:
      return initial.basis.frequency(name.mode);
    case UnknownKind::kDampingRatio:
      return initial.basis.zeta[name.mode];
    case UnknownKind::kDampingFactor:
      return 1.0;
    case UnknownKind::kDampingPower:
      return 0.0;
    case UnknownKind::kGain:
      return initial.sensors.gain;
    case UnknownKind::kDelay:
      return initial.sensors.delay;
    case UnknownKind::kCorner:
      return 0.5 * initial.sensors.corner / pi;
  }
  return 0.0;
}

StatedPriors::Entry entry_of(const ParameterPrior& prior, const UnknownName& name,
                             const ModelPoint& initial) {
  const double mean = std::isnan(prior.mean) ? initial_value(name, initial) : prior.mean;
  StatedPriors::Entry entry{name, mean, prior.deviation, prior.parameter};
  if (is_positive(name.kind)) {
    entry.mean = std::log(mean);
    entry.deviation = prior.deviation / mean;
  }
  if (name.kind == UnknownKind::kCorner) {
    entry.mean = 2.0 * pi * mean;
    entry.deviation = 2.0 * pi * prior.deviation;
  }
  if (name.kind == UnknownKind::kDampingFactor) {
    entry.name.kind = UnknownKind::kDampingRatio;
    entry.mean += std::log(initial.basis.zeta[0]);
  }
  if (name.kind == UnknownKind::kDampingPower) {
    const double stated = std::log(initial.basis.zeta[1] / initial.basis.zeta[0]);
    entry.mean = stated + mean * std::numbers::ln2;
    entry.deviation *= std::numbers::ln2;
  }
  return entry;
}

}  // namespace

void ParameterPrior::visit(OptionVisitor& visitor) {
  visitor.text(
      {.key = "parameter",
       .meaning = "f0, B, x_c, f_3, zeta_3, damping, damping_power, gain, delay or corner; "
                  "of a further record: x_c 2",
       .required = true},
      parameter);
  // The unit is that of the parameter, which stands before it.
  visitor.number({.key = "mean",
                  .meaning = "mean of the prior, in the unit of the parameter",
                  .unit = unit_of_unknown(parameter),
                  .word = "initial"},
                 mean);
  visitor.number({.key = "deviation",
                  .meaning = "standard deviation of the prior, in the unit of the parameter",
                  .unit = unit_of_unknown(parameter),
                  .range = Range::positive(),
                  .required = true},
                 deviation);
}

void PriorCorrelation::visit(OptionVisitor& visitor) {
  visitor.texts({.key = "between", .meaning = "two parameters that have priors", .required = true},
                between);
  visitor.number({.key = "value",
                  .meaning = "their correlation",
                  .unit = "1",
                  .range = Range::open(-1.0, 1.0),
                  .required = true},
                 value);
}

StatedPriors::StatedPriors(const UnknownsOptions& options, const ModelPoint& initial,
                           std::size_t records) {
  require_priors(options, initial.basis.size(), records, initial.basis.length);
  for (const std::string& name : options.per_record) own_.push_back(parse_unknown(name)->kind);
  // The factor of the damping is stated through a ratio.
  if (options.own(UnknownKind::kDampingFactor)) own_.push_back(UnknownKind::kDampingRatio);
  const StiffStringFit law = law_of(with_fixed(initial, options).basis);
  held_ = held_parameters(options, initial.basis.size(), records, initial.contact, law.fundamental,
                          law.inharmonicity);
  for (const ParameterPrior& prior : options.priors) {
    entries_.push_back(
        entry_of(prior, require_unknown(prior.parameter, initial.basis.size()), initial));
  }
  correlation_ = prior_correlation(options);
}

StatedPriors::Found StatedPriors::found(const Coordinate& coordinate) const {
  Found result;
  std::vector<double> means;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    std::optional<LinearForm> form = coordinate(entries_[i].name);
    if (!form) continue;
    result.forms.push_back(std::move(*form));
    result.which.push_back(i);
    means.push_back(entries_[i].mean);
  }
  result.means =
      Eigen::Map<const Eigen::VectorXd>(means.data(), static_cast<Eigen::Index>(means.size()));
  return result;
}

void StatedPriors::state(const Coordinate& coordinate, PriorEquations& equations) const {
  const Found stated = found(coordinate);
  equations.add(stated.forms, stated.means, covariance(stated.which));
}

PriorMisfit StatedPriors::misfit(const Coordinate& coordinate, const Eigen::VectorXd& z) const {
  const Found stated = found(coordinate);
  PriorMisfit misfit{.count = stated.forms.size()};
  if (stated.forms.empty()) return misfit;
  const Eigen::MatrixXd covariances = covariance(stated.which);
  Eigen::VectorXd residual(stated.means.size());
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    const LinearForm& form = stated.forms[static_cast<std::size_t>(i)];
    residual[i] =
        (form.slope.dot(z) + form.offset - stated.means[i]) / std::sqrt(covariances(i, i));
    if (i > 0 && !(std::abs(residual[i]) > misfit.deviations)) continue;
    misfit.deviations = std::abs(residual[i]);
    misfit.farthest = entries_[stated.which[static_cast<std::size_t>(i)]].parameter;
  }
  const Eigen::VectorXd scale = covariances.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * covariances * scale.asDiagonal();
  misfit.chi2 = residual.dot(correlation.llt().solve(residual));
  return misfit;
}

Eigen::MatrixXd StatedPriors::covariance(const std::vector<std::size_t>& which) const {
  const auto count = static_cast<Eigen::Index>(which.size());
  Eigen::MatrixXd matrix(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      const std::size_t a = which[static_cast<std::size_t>(i)];
      const std::size_t b = which[static_cast<std::size_t>(j)];
      matrix(i, j) = correlation_(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) *
                     entries_[a].deviation * entries_[b].deviation;
    }
  }
  return matrix;
}

StatedPriors StatedPriors::kept(const std::vector<Eigen::Index>& entries) const {
  StatedPriors result;
  result.held_ = held_;
  result.own_ = own_;
  for (const Eigen::Index i : entries) {
    result.entries_.push_back(entries_[static_cast<std::size_t>(i)]);
  }
  // What is left of a Gaussian: its marginal.
  result.correlation_ = correlation_(entries, entries);
  return result;
}

StatedPriors StatedPriors::without_frequencies() const {
  std::vector<Eigen::Index> others;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i].name.kind == UnknownKind::kFrequency) continue;
    others.push_back(static_cast<Eigen::Index>(i));
  }
  return kept(others);
}

StatedPriors StatedPriors::holding(const std::vector<std::size_t>& modes) const {
  std::vector<Eigen::Index> others;
  std::vector<bool> held = held_.frequencies;
  for (const std::size_t n : modes) {
    if (held.size() <= n) held.resize(n + 1);
    held[n] = true;
  }
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const UnknownName& name = entries_[i].name;
    const bool of_held = name.mode < held.size() && held[name.mode];
    if (name.kind == UnknownKind::kFrequency && of_held) continue;
    others.push_back(static_cast<Eigen::Index>(i));
  }
  StatedPriors result = kept(others);
  result.held_.frequencies = std::move(held);
  return result;
}

StatedPriors StatedPriors::of_record(std::size_t record) const {
  std::vector<Eigen::Index> known;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const UnknownName& name = entries_[i].name;
    const bool own = std::find(own_.begin(), own_.end(), name.kind) != own_.end();
    if (own && name.record != record) continue;
    known.push_back(static_cast<Eigen::Index>(i));
  }
  StatedPriors result = kept(known);
  result.held_ = held_.of_record(record);
  for (Entry& entry : result.entries_) entry.name.record = 0;
  return result;
}

bool StatedPriors::has(const UnknownName& name) const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Entry& entry) { return entry.name == name; });
}

}  // namespace modcal
