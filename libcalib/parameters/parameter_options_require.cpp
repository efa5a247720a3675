// What may be fixed or have a prior: values that no string has, correlations of no Gaussian.
#include <algorithm>
#include <cmath>
#include <optional>

#include "libcalib/parameters/damping_choice.hpp"
#include "libcalib/parameters/parameter_options.hpp"
#include "libsim/base/dense_solvers.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using Kind = ParameterKind;

// "x_c 2" of two records, where each has its own.
void require_record(const UnknownsOptions& options, const std::string& what,
                    const ParameterName& name, std::size_t records) {
  MODCAL_REQUIRE(name.record < records, "{}: there {} {} record{}", what,
                 records == 1 ? "is" : "are", records, records == 1 ? "" : "s");
  MODCAL_REQUIRE(name.record == 0 || options.own(name),
                 "{}: all records share it, state it without a number", what);
}

// What is fixed by another option has one place to say so.
void require_fixable(const std::string& parameter, Kind kind) {
  MODCAL_REQUIRE(kind != Kind::kDampingFactor,
                 "{} cannot be fixed by itself: state damping: fixed, or each and the ratios that "
                 "are fixed",
                 parameter);
  MODCAL_REQUIRE(kind != Kind::kDampingPower, "{} cannot be fixed by itself: state damping: factor",
                 parameter);
  MODCAL_REQUIRE(kind != Kind::kSensor,
                 "{} is fixed where it is stated: leave it out of the sensors, and state {}: ...",
                 parameter, parameter);
}

void require_fixed(const UnknownsOptions& options, std::size_t modes, std::size_t records) {
  std::vector<ParameterName> names;
  std::size_t frequencies = 0;
  for (const FixedParameter& fixed : options.fixed) {
    const ParameterName name = require_parameter(fixed.parameter, modes);
    require_fixable(fixed.parameter, name.kind);
    require_record(options, fmt::format("\"{}\" is fixed", fixed.parameter), name, records);
    MODCAL_REQUIRE(std::find(names.begin(), names.end(), name) == names.end(),
                   "\"{}\" is fixed twice: state it once", fixed.parameter);
    MODCAL_REQUIRE(
        std::isnan(fixed.value) || name.kind == Kind::kInharmonicity || fixed.value > 0.0,
        "{} is fixed at {:g}: it must be > 0", fixed.parameter, fixed.value);
    MODCAL_REQUIRE(!(name.kind == Kind::kDampingRatio && fixed.value >= 1.0),
                   "{} is fixed at {:g}: a mode rings below 1", fixed.parameter, fixed.value);
    frequencies += name.kind == Kind::kFrequency ? 1 : 0;
    names.push_back(name);
  }
  const auto has = [&](Kind kind) {
    return std::find(names.begin(), names.end(), ParameterName{.kind = kind}) != names.end();
  };
  MODCAL_REQUIRE(
      (has(Kind::kFundamental) && has(Kind::kInharmonicity)) || frequencies + 2 <= modes ||
          frequencies == 0,
      "{} of {} frequencies are fixed: the law has no two modes left to be found by; fix "
      "f0 and B too, or free some",
      frequencies, modes);
}

void require_sharing(const UnknownsOptions& options) {
  std::vector<std::string> seen;
  for (const std::string& name : options.per_record) {
    const std::optional<ParameterName> parsed = parse_parameter(name);
    MODCAL_REQUIRE(parsed && parsed->record == 0 && type_of(*parsed).may_be_own,
                   "\"{}\" cannot be each record's own: x_c, {} and damping can", name,
                   fmt::join(sensor_names(), ", "));
    MODCAL_REQUIRE(std::find(seen.begin(), seen.end(), name) == seen.end(),
                   "per_record names \"{}\" twice", name);
    seen.push_back(name);
    MODCAL_REQUIRE(parsed->kind != Kind::kSensor || options.sensor[parsed->index].free,
                   "per_record names {}, which is fixed: name it among the sensors", name);
    MODCAL_REQUIRE(
        parsed->kind != Kind::kDampingFactor ||
            damping_choice(options.damping) == DampingChoice::kFactor,
        "per_record names damping, which is {}: a factor alone can be each record's own, "
        "state damping: factor",
        options.damping);
  }
}

void require_free(const UnknownsOptions& options, const std::string& parameter,
                  const ParameterName& name) {
  const Kind kind = name.kind;
  MODCAL_REQUIRE(kind != Kind::kSensor || options.sensor[name.index].free,
                 "{} has a prior and is not free: name it among the sensors", parameter);
  const std::string& damping = options.damping;
  const DampingChoice free = damping_choice(damping);
  MODCAL_REQUIRE(kind != Kind::kDampingRatio || free > DampingChoice::kFixed,
                 "{} has a prior and is not free: state damping: each, factor or power", parameter);
  MODCAL_REQUIRE(
      kind != Kind::kDampingFactor || free == DampingChoice::kFactor ||
          free == DampingChoice::kPower,
      "{} is the factor of all damping ratios, and damping is {}: state damping: factor or power",
      parameter, damping);
  MODCAL_REQUIRE(kind != Kind::kDampingPower || free == DampingChoice::kPower,
                 "{} is the exponent of the mode number, and damping is {}: state damping: power",
                 parameter, damping);
}

// A factor or power of the damping is measured by the first two ratios.
void require_not_fixed(const UnknownsOptions& options, const std::string& parameter,
                       const ParameterName& name) {
  for (const FixedParameter& fixed : options.fixed) {
    const std::optional<ParameterName> held = parse_parameter(fixed.parameter);
    MODCAL_REQUIRE(held != name, "{} has a prior and is fixed: state one of the two", parameter);
    const bool by_ratio = held && held->kind == Kind::kDampingRatio;
    MODCAL_REQUIRE(!(by_ratio && held->index == 0 && name.kind == Kind::kDampingFactor) &&
                       !(by_ratio && held->index < 2 && name.kind == Kind::kDampingPower),
                   "the prior of {} acts through zeta_1 and zeta_2, and {} is fixed: state a prior "
                   "of another ratio",
                   parameter, fixed.parameter);
  }
}

// What a mean or a fixed value says of a string; NaN: the initial value, which a string has.
void require_value_of_string(const std::string& parameter, Kind kind, double value,
                             std::size_t modes, double length) {
  if (std::isnan(value)) return;
  MODCAL_REQUIRE(kind != Kind::kContact || (value > 0.0 && value < length),
                 "{} is stated as {:g} m: the contact lies on the string, within (0, {:g}) m",
                 parameter, value, length);
  // As in StringUnknowns::admits().
  const double top = static_cast<double>(modes);
  MODCAL_REQUIRE(kind != Kind::kInharmonicity || 1.0 + value * top * top > 0.25,
                 "{} is stated as {:g}: with {} modes no string has such a law, it must be above "
                 "{:.3g}",
                 parameter, value, modes, -0.75 / (top * top));
}

ParameterName require_prior(const UnknownsOptions& options, const ParameterPrior& prior,
                            std::size_t modes, std::size_t records) {
  const ParameterName name = require_parameter(prior.parameter, modes);
  require_record(options, fmt::format("the prior of \"{}\"", prior.parameter), name, records);
  MODCAL_REQUIRE(name.kind != Kind::kDampingPower || modes > 1,
                 "the prior of \"{}\": {} mode has no power of the mode number", prior.parameter,
                 modes);
  require_free(options, prior.parameter, name);
  require_not_fixed(options, prior.parameter, name);
  MODCAL_REQUIRE(prior.deviation > 0.0 && std::isfinite(prior.deviation),
                 "the prior of {} has the deviation {:g}: it must be > 0 and finite",
                 prior.parameter, prior.deviation);
  MODCAL_REQUIRE(std::isnan(prior.mean) || std::isfinite(prior.mean),
                 "the prior of {} has the mean {:g}: it must be finite, or left out for the value "
                 "stated",
                 prior.parameter, prior.mean);
  MODCAL_REQUIRE(std::isnan(prior.mean) || !type_of(name).logarithmic || prior.mean > 0.0,
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

}  // namespace

Eigen::MatrixXd prior_correlation(const UnknownsOptions& options) {
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

void require_priors(const UnknownsOptions& options, std::size_t modes, std::size_t records,
                    double length) {
  require_sharing(options);
  require_fixed(options, modes, records);
  for (const FixedParameter& fixed : options.fixed) {
    const ParameterName name = require_parameter(fixed.parameter, modes);
    require_value_of_string(fixed.parameter, name.kind, fixed.value, modes, length);
  }
  std::vector<ParameterName> names;
  for (const ParameterPrior& prior : options.priors) {
    const ParameterName name = require_prior(options, prior, modes, records);
    require_value_of_string(prior.parameter, name.kind, prior.mean, modes, length);
    MODCAL_REQUIRE(std::find(names.begin(), names.end(), name) == names.end(),
                   "\"{}\" has two priors: state one", prior.parameter);
    names.push_back(name);
  }
  const bool factor_stated = std::any_of(names.begin(), names.end(), [](const ParameterName& name) {
    return name.kind == Kind::kDampingFactor;
  });
  const ParameterName first_ratio{.kind = Kind::kDampingRatio};
  MODCAL_REQUIRE(
      !factor_stated || std::find(names.begin(), names.end(), first_ratio) == names.end(),
      "damping and zeta_1 both have priors: the factor is that of zeta_{}, state one", 1);
  if (options.priors.empty()) {
    MODCAL_REQUIRE(options.correlations.empty(),
                   "{} have a correlation and no priors: list both under priors",
                   fmt::join(options.correlations.front().between, " and "));
    return;
  }
  const double least = symmetric_eigenvalues(prior_correlation(options)).minCoeff();
  MODCAL_REQUIRE(least > 1e-10,
                 "the correlations of the priors belong to no Gaussian: the smallest eigenvalue of "
                 "their matrix is {:.3g} and must be > 0; bring them closer to 0",
                 least);
}

}  // namespace modcal
