// What a calibration found, described once for its tables and its JSON, and its figures.

#include <complex>
#include <numbers>

#include "experiments/kinds/calibrate/calibrate.hpp"

namespace modcal {
namespace {

constexpr auto kInJson = ResultVisitor::kInJson;
constexpr auto kInTables = ResultVisitor::kInTables;

void visit_parameter(ResultVisitor& row, const CalibratedParameter& parameter) {
  row({.key = "name"}, parameter.name);
  row({.key = kInitialKey, .format = "{:.8g}"}, parameter.initial);
  row({.key = kFinalKey, .format = "{:.8g}"}, parameter.final);
  row({.key = "at_bound", .shown = kInJson}, parameter.at_bound);
  row({.key = kDeviationKey, .name = "standard deviation", .format = "{:.3g}"},
      known(parameter.deviation));
  row({.key = kUnitKey}, parameter.unit);
  row({.key = "meaning"}, meaning_of_parameter(parameter.name));
}

void visit_verdict(ResultVisitor& row, const ContinuationResult& fit, std::size_t n) {
  const ModeVerdict& found = fit.modes[n];
  row({.key = "relative_sd", .name = "relative sd", .format = "{:.1e}"}, found.deviation);
  row({.key = "data_sd", .name = "by its data alone", .format = "{:.1e}"}, found.data_deviation);
  row({.key = "verdict", .shown = kInTables}, verdict_text(found));
  row({.key = "source", .shown = kInJson}, name_of(found.source));
  row({.key = "reason", .shown = kInJson}, name_of(found.reason));
  row({.key = "law", .shown = kInJson}, name_of(found.tie));
  row({.key = "beyond_law", .shown = kInJson}, found.departure);
  if (fit.local.modes.empty()) return;
  row({.key = "chi2", .name = "chi2 about it", .format = "{:.2f}"}, known(fit.local.modes[n].chi2));
}

void visit_mode(ResultVisitor& row, const CalibrationOutcome& outcome, const CalibratedMode& mode) {
  const double refined = outcome.refined.basis.frequency(mode.number - 1);
  std::optional<double> truth, error;
  if (!outcome.true_frequencies.empty()) {
    truth = outcome.true_frequencies[mode.number - 1];
    error = refined / *truth - 1.0;
  }
  row({.key = "n"}, mode.number);
  row({.key = "f_true_hz", .name = "true", .unit = "Hz", .format = "{:.3f}"}, truth);
  row({.key = "f_initial_hz", .name = "initial", .unit = "Hz", .format = "{:.3f}"},
      mode.initial_frequency);
  row({.key = "f_hz", .name = "refined", .unit = "Hz", .format = "{:.3f}"}, refined);
  row({.key = "relative_error", .name = "relative error", .format = "{:.2e}", .shown = kInTables},
      error);
  if (const auto& found = outcome.result.continuation) {
    visit_verdict(row, *found, mode.number - 1);
  }
  const auto damping = std::ranges::find(
      outcome.result.parameters, fmt::format("zeta_{}", mode.number), &CalibratedParameter::name);
  if (outcome.frees_damping_of_modes()) {
    const bool is_free = damping != outcome.result.parameters.end();
    row({.key = "zeta", .name = "damping ratio", .format = "{:.3g}", .shown = kInTables},
        outcome.refined.basis.zeta[mode.number - 1]);
    row({.key = "zeta_sd", .name = "its sd", .format = "{:.2g}", .shown = kInTables},
        is_free ? known(damping->deviation) : std::nullopt);
  }
  row({.key = "excited"}, mode.excited);
  row({.key = "searched", .shown = kInJson}, mode.searched);
  row({.key = "shape_at_contact", .name = "mode shape at the contact", .format = "{:.3f}"},
      mode.shape);
}

void visit_stage(ResultVisitor& row, const FitStage& stage) {
  row({.key = "name", .name = "stage"}, stage.name);
  row({.key = "evaluations", .name = "evaluations so far"}, stage.evaluations);
  row({.key = "objective", .format = "{:.6g}"}, stage.objective);
  row({.key = "chi2", .name = "reduced chi2", .format = "{:.4f}"}, known(stage.chi2));
}

void visit_misfit(ResultVisitor& visitor, const PriorMisfit& misfit) {
  visitor({.key = "chi2"}, misfit.chi2);
  visitor({.key = "count"}, misfit.count);
  visitor({.key = "contradicted"}, misfit.contradicted());
  visitor({.key = "farthest"}, misfit.farthest);
  visitor({.key = "deviations"}, misfit.deviations);
}

void visit_covariance(ResultVisitor& visitor, const NamedCovariance& covariance) {
  std::vector<std::string_view> units;
  std::vector<double> deviations;
  std::vector<std::vector<double>> correlations(covariance.size());
  const Eigen::MatrixXd matrix = covariance.correlations();
  for (std::size_t i = 0; i < covariance.size(); ++i) {
    units.push_back(unit_of_parameter(covariance.names[i]));
    deviations.push_back(covariance.deviation(i));
    const auto row = matrix.row(static_cast<Eigen::Index>(i));
    correlations[i].assign(row.begin(), row.end());
  }
  visitor({.key = "names"}, covariance.names);
  visitor({.key = "units"}, units);
  visitor({.key = "sd"}, deviations);
  visitor({.key = "correlations"}, correlations);
  visitor({.key = "singular_values"}, covariance.singular_values());
  visitor({.key = "condition"}, covariance.condition());
}

// Knots of the smooth response of the sensor at x = L.
void visit_response(ResultVisitor& visitor, const ContinuationResult& found) {
  const SmoothResponse& smooth = found.model.sensors.smooth;
  visitor.list({.key = "sensor_response"}, found.response_deviations.size(), {},
               [&](ResultVisitor& row, std::size_t k) {
                 const std::complex<double> value = smooth.knots[k];
                 const std::complex<double> deviation = found.response_deviations[k];
                 row({.key = "frequency_hz"},
                     static_cast<double>(k) * smooth.spacing / (2.0 * std::numbers::pi));
                 row({.key = "log_gain"}, value.real());
                 row({.key = "log_gain_sd"}, deviation.real());
                 row({.key = "phase_rad"}, value.imag());
                 row({.key = "phase_sd_rad"}, deviation.imag());
               });
}

void visit_estimate(ResultVisitor& visitor, const ContinuationResult& found) {
  const auto group = [&visitor](std::string_view key, auto visit, const auto& value) {
    visitor.group({.key = key}, [&](ResultVisitor& members) { visit(members, value); });
  };
  visitor({.key = "right"}, found.right && unknown_values(found).empty());
  visitor({.key = "fits"}, found.fits);
  visitor({.key = "chi2"}, found.chi2);
  visitor({.key = "chi2_sd"}, found.chi2_deviation);
  visitor({.key = "law_chi2"}, found.law.chi2);
  visitor({.key = "law_accepted"}, found.law.accepted);
  group("priors", visit_misfit, found.priors);
  group("law_priors", visit_misfit, found.law.priors);
  visitor({.key = "law_width"}, found.law_width);
  visitor({.key = "f0_sd_hz"}, found.found_law.deviation[0]);
  visitor({.key = "B_sd"}, found.found_law.deviation[1]);
  visitor({.key = "x_c_sd_m"}, found.contact_deviation);
  visitor({.key = "damping_sd"}, found.damping_deviation);
  visitor({.key = "noise_left_n"}, found.noise[0]);
  visitor({.key = "noise_right_n"}, found.noise[1]);
  visit_response(visitor, found);
  visitor({.key = "mains_lines_hz"}, found.lines);
  visitor({.key = "restarts"}, found.restarts);
  visitor({.key = "moved_modes"}, found.moved_modes);
  group("covariance", visit_covariance, found.covariance);
  group("law_covariance", visit_covariance, found.law.covariance);
  visitor.rows({.key = "stages"}, found.stages, visit_stage);
  visitor({.key = "x_c_sd_of_strokes_m"}, found.contact_deviations);
}

}  // namespace

std::vector<CalibratedParameter> CalibrationOutcome::beside_modes() const {
  std::vector<CalibratedParameter> beside = result.parameters;
  std::erase_if(beside, [](const auto& one) {
    return one.name.starts_with("f_") || one.name.starts_with("zeta_");
  });
  return beside;
}

void CalibrationOutcome::visit_parameters(ResultVisitor& visitor) const {
  visitor.rows({.table = "parameters", .name = "Parameters", .shown = kInTables}, beside_modes(),
               visit_parameter);
}

void CalibrationOutcome::visit(ResultVisitor& visitor) const {
  const OptimizationResult& search = result.search;
  const auto& found = result.continuation;
  visitor.group({.table = "search", .name = "Search"}, [&](ResultVisitor& row) {
    row({.key = "stop_reason", .name = "ended because"}, name_of(search.stop));
    row({.key = "evaluations"}, search.evaluations);
    row({.key = "loops"}, search.loops);
    row({.key = "seconds", .unit = "s", .is_effort = true}, search.seconds);
    row({.key = "objective_initial", .name = "objective, initial"}, known(search.initial_value));
    row({.key = "objective", .name = "objective, final"}, search.value);
    row({.key = "median_relative_error_excited",
         .name = "median relative error, excited modes",
         .format = "{:.3g}"},
        known(median_relative_error(*this)));
  });
  visitor({.key = "searched_by_loop"}, search.searched);
  if (found) {
    visitor.rows(
        {.table = "stages",
         .name = "Stages of the search",
         .meaning = "Every stage has a record of its own: damped by sigma, whole, or whole with "
                    "weighted bins. Objectives of different stages do not compare.",
         .shown = kInTables},
        found->stages, visit_stage);
  }
  visitor.rows({.key = "parameters", .shown = kInJson}, result.parameters, visit_parameter);
  visitor.rows(
      {.key = "modes", .table = "modes", .name = "Modal frequencies"}, result.modes,
      [this](ResultVisitor& row, const CalibratedMode& mode) { visit_mode(row, *this, mode); });
  if (found) visit_causes(visitor, *found);
  visitor.rows({.key = "trace"}, search.trace, [](ResultVisitor& item, const TracePoint& point) {
    item({}, std::pair(point.evaluations, point.value));
  });
  visitor({.key = "stiff_string_law", .optional = true}, law);
  if (!found) return;
  visitor.group({.key = "continuation", .shown = kInJson},
                [&](ResultVisitor& members) { visit_estimate(members, *found); });
}

}  // namespace modcal
