#include "libcalib/optimizers/staged/records_fit.hpp"

#include <optional>

#include "libcalib/optimizers/staged/joint_fit.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

void require_contacts(const UnknownsOptions& options, std::size_t strokes) {
  const auto require = [strokes](const std::string& parameter) {
    const std::optional<UnknownName> name = parse_unknown(parameter);
    MODCAL_REQUIRE(!name || name->kind != UnknownKind::kContact || name->record < strokes,
                   "\"{}\" is stated, but only strokes have a contact, and there {}: name one of "
                   "theirs, or state further_strokes",
                   parameter, strokes == 1 ? "is one" : fmt::format("are {}", strokes));
  };
  for (const ParameterPrior& prior : options.priors) require(prior.parameter);
  for (const FixedParameter& fixed : options.fixed) require(fixed.parameter);
}

RecordsFit calibrate_records(const ModelPoint& initial, std::span<const CalibrationData> strokes,
                             const ContinuationOptions& options,
                             std::span<const PluckRecord> plucks, const FitPoll& poll) {
  MODCAL_REQUIRE(!strokes.empty(), "a fit of several records needs at least {} stroke", 1);
  require_contacts(options.unknowns, strokes.size());
  ModelPoint stated = initial;
  stated.sensors = options.unknowns.sensors();
  const StatedPriors priors(options.unknowns, stated, strokes.size() + plucks.size());
  RecordsFit fit;
  for (std::size_t r = 0; r < strokes.size(); ++r) {
    fit.single.push_back(
        calibrate_by_continuation(initial, strokes[r], options, priors.of_record(r), poll));
  }
  fit_jointly(initial, options, priors, strokes, plucks, poll, fit);
  return fit;
}

ContinuationResult as_continuation(const RecordsFit& fit) {
  ContinuationResult result = fit.single.front();
  result.model = fit.model;
  result.contact_deviation = fit.contact_deviations.front();
  const RecordValues& first = fit.values.front();
  result.damping = first.damping;
  result.damping_deviation = first.damping_deviation;
  result.damping_power = fit.damping_power;
  result.damping_power_deviation = fit.damping_power_deviation;
  result.ratio_deviations = fit.ratio_deviations;
  result.sensor_deviation = first.sensor_deviation;
  result.chi2 = fit.chi2;
  result.chi2_deviation = fit.chi2_deviation;
  result.fits = fit.fits;
  result.priors = fit.priors;
  result.right = fit.right;
  result.law = fit.law;
  result.modes = fit.modes;
  result.covariance = fit.covariance;
  result.law_width = fit.law_width;
  result.evaluations = 0;
  result.stages.clear();
  for (std::size_t r = 0; r < fit.single.size(); ++r) {
    append_stages(fit.single[r].stages, fmt::format("stroke {}: ", r + 1), result.evaluations,
                  result.stages);
    result.evaluations += fit.single[r].evaluations;
  }
  append_stages(fit.stages, "all records: ", result.evaluations, result.stages);
  result.evaluations += fit.evaluations;
  return result;
}

}  // namespace modcal
