#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/report/result.hpp"

namespace modcal {

std::string to_deviation(double value, double deviation) {
  constexpr double kLeastPlain = 1e-3, kMostPlain = 1e6;
  if (value == 0.0) return "0";
  if (!(deviation > 0.0)) return fmt::format("{:.6g}", value);
  const auto place = [](double x) { return static_cast<int>(std::floor(std::log10(std::abs(x)))); };
  const int last = place(deviation) - 1;
  const double size = std::abs(value);
  if (size >= kLeastPlain && size < kMostPlain) {
    return fmt::format("{:.{}f}", value, std::clamp(-last, 0, 17));
  }
  return fmt::format("{:.{}e}", value, std::clamp(place(value) - last, 0, 17));
}

namespace {

// "30.00021 ± 0.00058 mm".
std::string answer_of(const CalibratedParameter& parameter, bool is_length) {
  constexpr double kBand = 1.96;
  const double scale = is_length ? 1e3 : 1.0;
  const std::string unit = is_length ? " mm" : parameter.unit == "1" ? "" : " " + parameter.unit;
  const double value =
      parameter.unit == "1" ? without_rounding(parameter.final) : scale * parameter.final;
  const double width = scale * kBand * parameter.deviation;
  const std::string text = fmt::format("{} = {}", parameter.name, to_deviation(value, width));
  return std::isnan(width) ? text + unit : fmt::format("{} ± {:.2g}{}", text, width, unit);
}

constexpr std::string_view kMeter = "m";

// What the page shows of a parameter: lengths in mm, no digit that says nothing.
void show(const CalibratedParameter& parameter, const report::Table& table,
          std::vector<report::Cell>& row) {
  const bool is_length = parameter.unit == kMeter;
  const double scale = is_length ? 1e3 : 1.0;
  const double deviation = scale * parameter.deviation;
  const auto cell = [&](std::string_view key) -> report::Cell& {
    const auto column = std::ranges::find(table.columns, key, &report::Column::key);
    return row.at(static_cast<std::size_t>(column - table.columns.begin()));
  };
  cell(kInitialKey).shown = to_deviation(scale * parameter.initial, deviation);
  cell(kFinalKey).shown = to_deviation(scale * parameter.final, deviation);
  if (!std::isnan(deviation)) cell(kDeviationKey).shown = fmt::format("{:.2g}", deviation);
  if (is_length) cell(kUnitKey).shown = "mm";
}

}  // namespace

std::vector<report::Table> parameter_tables(const CalibrationOutcome& outcome) {
  std::vector<report::Table> tables =
      report::tables_of([&outcome](ResultVisitor& visitor) { outcome.visit_parameters(visitor); });
  const std::vector<CalibratedParameter> parameters = outcome.beside_modes();
  for (report::Table& table : tables) {
    for (std::size_t i = 0; i < table.rows.size(); ++i) show(parameters[i], table, table.rows[i]);
  }
  return tables;
}

std::string calibration_answer(const CalibrationOutcome& outcome) {
  const ContinuationResult* found = outcome.result.continuation.get();
  std::vector<std::string> values;
  for (const CalibratedParameter& parameter : outcome.result.parameters) {
    const auto name = parse_parameter(parameter.name);
    if (!name) continue;
    const Moves moves = type_of(*name).moves;
    const bool of_law = moves == Moves::kFrequencies && !type_of(*name).of_mode;
    if (of_law || moves == Moves::kContact)
      values.push_back(answer_of(parameter, moves == Moves::kContact));
  }
  if (!found) return fmt::format("{}", fmt::join(values, ", "));
  const auto identified =
      std::ranges::count(found->modes, ModeSource::kIdentified, &ModeVerdict::source);
  return fmt::format("{} (95 %); {} of {} modes identified; the data do not contradict the fit.",
                     fmt::join(values, ", "), identified, found->modes.size());
}

}  // namespace modcal
