// Priors that no string has, and correlations of no Gaussian.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "libcalib/likelihood/string_unknowns.hpp"
#include "libcalib/parameters/stated_priors.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

void require_free(const UnknownsOptions& options, const std::string& parameter, UnknownKind kind) {
  const auto require_sensor = [&](const UnknownOption& sensor) {
    MODCAL_REQUIRE(sensor.free, "{} has a prior and is not free: name it among the sensors",
                   parameter);
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
                   "{} have a correlation and no priors: list both under priors",
                   fmt::join(options.correlations.front().between, " and "));
    return;
  }
  const double least =
      prior_correlation(options).selfadjointView<Eigen::Lower>().eigenvalues().minCoeff();
  MODCAL_REQUIRE(least > 1e-10,
                 "the correlations of the priors belong to no Gaussian: the smallest eigenvalue of "
                 "their matrix is {:.3g} and must be > 0; bring them closer to 0",
                 least);
}

}  // namespace modcal
