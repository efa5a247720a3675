#include "experiments/kinds/calibrate/calibrate_covariance.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "experiments/kinds/calibrate/calibrate_study.hpp"
#include "experiments/kinds/calibrate/correlation_text.hpp"
#include "libcalib/parameters/unknown_name.hpp"

namespace modcal {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kShownInText = 6, kShownInTable = 20;

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

// A frequency that the law or a prior holds moves with the others by that alone.
std::vector<bool> told_by_data(const ContinuationResult& found) {
  std::vector<bool> told(found.covariance.size(), true);
  for (std::size_t n = 0; found.frequencies_free && n < found.modes.size(); ++n) {
    const auto place = found.covariance.find(fmt::format("f_{}", n + 1));
    if (place) told[*place] = found.modes[n].source == ModeSource::kIdentified;
  }
  return told;
}

void add_rows(const NamedCovariance& covariance, const std::vector<bool>& taken,
              const std::string& fit, report::Table& table) {
  for (const CorrelatedPair& pair : strongest_correlations(covariance, taken, kShownInTable)) {
    table.rows.push_back(
        {fit, covariance.names[pair.first], covariance.names[pair.second], pair.correlation});
  }
}

std::string condition_text(const NamedCovariance& covariance) {
  const std::vector<double> values = covariance.singular_values();
  if (values.empty()) return "";
  return fmt::format("singular values in standard deviations {:.3g} to {:.3g}, condition {:.3g}\n",
                     values.front(), values.back(), covariance.condition());
}

}  // namespace

nlohmann::ordered_json covariance_json(const NamedCovariance& covariance) {
  Json names = Json::array(), units = Json::array(), deviations = Json::array();
  Json rows = Json::array(), singular_values = Json::array();
  const Eigen::MatrixXd correlations = covariance.correlations();
  for (std::size_t i = 0; i < covariance.size(); ++i) {
    names.push_back(covariance.names[i]);
    units.push_back(unit_of_unknown(covariance.names[i]));
    deviations.push_back(number_or_null(covariance.deviation(i)));
    Json row = Json::array();
    for (const double value : correlations.row(static_cast<Eigen::Index>(i))) {
      row.push_back(number_or_null(value));
    }
    rows.push_back(std::move(row));
  }
  for (const double value : covariance.singular_values()) {
    singular_values.push_back(number_or_null(value));
  }
  return {{"names", std::move(names)},
          {"units", std::move(units)},
          {"sd", std::move(deviations)},
          {"correlations", std::move(rows)},
          {"singular_values", std::move(singular_values)},
          {"condition", number_or_null(covariance.condition())}};
}

std::string covariance_text(const ContinuationResult& found) {
  std::string text = "stiff-string law:\n" + correlation_lines(found.law.covariance) + "  " +
                     condition_text(found.law.covariance);
  if (!found.frequencies_free) return text;
  text += "every frequency free, strongest correlations:";
  for (const CorrelatedPair& pair :
       strongest_correlations(found.covariance, told_by_data(found), kShownInText)) {
    const auto& names = found.covariance.names;
    text += fmt::format("{}{} with {}", text.back() == ':' ? " " : ", ", names[pair.second],
                        names[pair.first]);
    text += fmt::format(" {:+.2f}", pair.correlation);
  }
  return text + "\n  " + condition_text(found.covariance);
}

report::Table correlation_table(const ContinuationResult& found, const std::string& command) {
  report::Table table{.id = "correlations",
                      .title = "Strongest correlations",
                      .caption =
                          "Of the law fitted by itself and, where every frequency is free, "
                          "of all that the data identify; calibration.json has them all.",
                      .columns = {{.key = "fit"},
                                  {.key = "parameter"},
                                  {.key = "with"},
                                  {.key = "correlation", .format = "{:+.3f}"}},
                      .command = command};
  const NamedCovariance& law = found.law.covariance;
  add_rows(law, std::vector<bool>(law.size(), true), "law", table);
  if (found.frequencies_free) {
    add_rows(found.covariance, told_by_data(found), "every frequency", table);
  }
  return table;
}

void add_covariance(const CalibrationOutcome& outcome, const std::string& command,
                    StudyResult& result) {
  const auto& found = outcome.result.continuation;
  if (!found) return;
  result.summary += covariance_text(*found);
  result.blocks.emplace_back(correlation_table(*found, command));
}

}  // namespace modcal
