#include "libcalib/likelihood/stated_priors.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/likelihood/string_unknowns.hpp"
#include "libcalib/stiff_string_fit.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using std::numbers::pi;

void require_free(const UnknownsOptions& options, const std::string& parameter, UnknownKind kind) {
  const auto require_sensor = [&](const UnknownOption& sensor) {
    MODCAL_REQUIRE(sensor.free, "{} has a prior and is not free: state {}: {{free: true}}",
                   parameter, parameter);
  };
  if (kind == UnknownKind::kGain) require_sensor(options.gain);
  if (kind == UnknownKind::kDelay) require_sensor(options.delay);
  if (kind == UnknownKind::kCorner) require_sensor(options.corner);
  const std::string& damping = options.damping;
  MODCAL_REQUIRE(kind != UnknownKind::kDampingRatio || damping != "fixed",
                 "{} has a prior and is not free: state damping: each, factor or power", parameter);
  MODCAL_REQUIRE(
      kind != UnknownKind::kDampingFactor || damping == "factor" || damping == "power",
      "{} is the factor of all damping ratios, and damping is {}: state damping: factor or power",
      parameter, damping);
  MODCAL_REQUIRE(kind != UnknownKind::kDampingPower || damping == "power",
                 "{} is the exponent of the mode number, and damping is {}: state damping: power",
                 parameter, damping);
}

// A factor or power of the damping is measured by the first two ratios.
void require_not_fixed(const UnknownsOptions& options, const std::string& parameter,
                       const UnknownName& name) {
  for (const FixedParameter& fixed : options.fixed) {
    const std::optional<UnknownName> held = parse_unknown(fixed.parameter);
    MODCAL_REQUIRE(held != name, "{} has a prior and is fixed: state one of the two", parameter);
    const bool by_ratio = held && held->kind == UnknownKind::kDampingRatio;
    MODCAL_REQUIRE(!(by_ratio && held->mode == 0 && name.kind == UnknownKind::kDampingFactor) &&
                       !(by_ratio && held->mode < 2 && name.kind == UnknownKind::kDampingPower),
                   "the prior of {} acts through zeta_1 and zeta_2, and {} is fixed: state a prior "
                   "of another ratio",
                   parameter, fixed.parameter);
  }
}

// What a mean or a fixed value says of a string; NaN: the initial value, which a string has.
void require_value_of_string(const std::string& parameter, UnknownKind kind, double value,
                             std::size_t modes, double length) {
  if (std::isnan(value)) return;
  MODCAL_REQUIRE(kind != UnknownKind::kContact || (value > 0.0 && value < length),
                 "{} is stated as {:g} m: the contact lies on the string, within (0, {:g}) m",
                 parameter, value, length);
  // As in StringUnknowns::admits().
  const double top = static_cast<double>(modes);
  MODCAL_REQUIRE(kind != UnknownKind::kInharmonicity || 1.0 + value * top * top > 0.25,
                 "{} is stated as {:g}: with {} modes no string has such a law, it must be above "
                 "{:.3g}",
                 parameter, value, modes, -0.75 / (top * top));
}

UnknownName require_prior(const UnknownsOptions& options, const ParameterPrior& prior,
                          std::size_t modes, std::size_t records) {
  const UnknownName name = require_unknown(prior.parameter, modes);
  MODCAL_REQUIRE(name.record < records, "the prior of \"{}\": there {} {} record{}",
                 prior.parameter, records == 1 ? "is" : "are", records, records == 1 ? "" : "s");
  MODCAL_REQUIRE(name.record == 0 || options.own(name.kind),
                 "the prior of \"{}\": all records share it, state it without a number",
                 prior.parameter);
  MODCAL_REQUIRE(name.kind != UnknownKind::kDampingPower || modes > 1,
                 "the prior of \"{}\": {} mode has no power of the mode number", prior.parameter,
                 modes);
  require_free(options, prior.parameter, name.kind);
  require_not_fixed(options, prior.parameter, name);
  MODCAL_REQUIRE(prior.deviation > 0.0 && std::isfinite(prior.deviation),
                 "the prior of {} has the deviation {:g}: it must be > 0 and finite",
                 prior.parameter, prior.deviation);
  MODCAL_REQUIRE(std::isnan(prior.mean) || std::isfinite(prior.mean),
                 "the prior of {} has the mean {:g}: it must be finite, or left out for the value "
                 "stated",
                 prior.parameter, prior.mean);
  MODCAL_REQUIRE(std::isnan(prior.mean) || !is_positive(name.kind) || prior.mean > 0.0,
                 "the prior of {} has the mean {:g}: it must be > 0", prior.parameter, prior.mean);
  return name;
}

std::size_t place_of(const UnknownsOptions& options, const std::string& parameter) {
  const auto found =
      std::find_if(options.priors.begin(), options.priors.end(),
                   [&](const ParameterPrior& prior) { return prior.parameter == parameter; });
  MODCAL_REQUIRE(found != options.priors.end(),
                 "correlation with \"{}\", which has no prior: state one, or leave the correlation "
                 "out",
                 parameter);
  return static_cast<std::size_t>(found - options.priors.begin());
}

Eigen::MatrixXd correlation_of(const UnknownsOptions& options) {
  const auto count = static_cast<Eigen::Index>(options.priors.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(count, count);
  for (const auto& [between, value] : options.correlations) {
    MODCAL_REQUIRE(between.size() == 2 && between[0] != between[1],
                   "a correlation is between two different parameters, not {}",
                   fmt::join(between, ", "));
    MODCAL_REQUIRE(std::abs(value) < 1.0,
                   "correlation {:g} between {} and {}: it must lie in (-1, 1)", value, between[0],
                   between[1]);
    const auto i = static_cast<Eigen::Index>(place_of(options, between[0]));
    const auto j = static_cast<Eigen::Index>(place_of(options, between[1]));
    MODCAL_REQUIRE(matrix(i, j) == 0.0, "the correlation between {} and {} is stated twice",
                   between[0], between[1]);
    matrix(i, j) = matrix(j, i) = value;
  }
  return matrix;
}

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

void require_priors(const UnknownsOptions& options, std::size_t modes, std::size_t records,
                    double length) {
  options.require_sharing();
  require_fixed(options, modes, records);
  for (const FixedParameter& fixed : options.fixed) {
    const UnknownName name = require_unknown(fixed.parameter, modes);
    require_value_of_string(fixed.parameter, name.kind, fixed.value, modes, length);
  }
  std::vector<UnknownName> names;
  for (const ParameterPrior& prior : options.priors) {
    const UnknownName name = require_prior(options, prior, modes, records);
    require_value_of_string(prior.parameter, name.kind, prior.mean, modes, length);
    MODCAL_REQUIRE(std::find(names.begin(), names.end(), name) == names.end(),
                   "\"{}\" has two priors: state one", prior.parameter);
    names.push_back(name);
  }
  const bool factor_stated = std::any_of(names.begin(), names.end(), [](const UnknownName& name) {
    return name.kind == UnknownKind::kDampingFactor;
  });
  const UnknownName first_ratio{.kind = UnknownKind::kDampingRatio};
  MODCAL_REQUIRE(
      !factor_stated || std::find(names.begin(), names.end(), first_ratio) == names.end(),
      "damping and zeta_1 both have priors: the factor is that of zeta_{}, state one", 1);
  if (options.priors.empty()) {
    MODCAL_REQUIRE(options.correlations.empty(),
                   "{} correlations of priors that are not stated: list them under priors",
                   options.correlations.size());
    return;
  }
  const double least =
      correlation_of(options).selfadjointView<Eigen::Lower>().eigenvalues().minCoeff();
  MODCAL_REQUIRE(least > 1e-10,
                 "the correlations of the priors belong to no Gaussian: the smallest eigenvalue of "
                 "their matrix is {:.3g} and must be > 0; bring them closer to 0",
                 least);
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
  correlation_ = correlation_of(options);
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
