#include "libinverse/parameter_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "libinverse/spectral/choices/rules.hpp"
#include "libinverse/spectral/choices/tuning.hpp"
#include "libinverse/spectral/problem/spectral_system.hpp"
#include "libsim/base/words.hpp"

namespace modcal {
namespace {

constexpr std::array<std::string_view, 2> kMeasures = {"solution", "derivative"};

}  // namespace

std::string_view name_of(ChoiceStatus status) {
  static constexpr std::array<std::string_view, 7> kNames = {
      "not_computed",        "chosen",     "given", "no_parameter", "edge_of_range",
      "no_interior_minimum", "not_reached"};
  return kNames.at(static_cast<std::size_t>(status));
}

void CurveOptions::visit(OptionVisitor& visitor) {
  visitor("points", "number of parameters searched, logarithmically spaced",
          {.range = Range::closed(0, 1e6)}, points);
  visitor("lowest",
          "lowest parameter searched; auto: the smallest singular value > 0, at "
          "most 8 decades below the largest",
          {.range = Range::positive(), .word = "auto"}, lowest);
  visitor("highest", "highest parameter searched; auto: the largest singular value",
          {.range = Range::positive(), .word = "auto"}, highest);
  visitor("measure",
          "norm of the solution on the curve: of the force's time derivative or of "
          "the force itself",
          {.choices = {kMeasures[1], kMeasures[0]}}, measure);
}

std::string warning_of(const ChosenParameter& choice) {
  const bool stand_in = choice.status == ChoiceStatus::kNoInteriorMinimum ||
                        choice.status == ChoiceStatus::kEdgeOfRange ||
                        choice.status == ChoiceStatus::kNotReached ||
                        choice.status == ChoiceStatus::kNotComputed;
  return stand_in ? choice.explanation : std::string();
}

ParameterChoice::ParameterChoice(CurveOptions options, std::int64_t least_points)
    : options_(std::move(options)),
      measure_(enum_of<Measure>(kMeasures, "measure", options_.measure)) {
  MODCAL_REQUIRE(options_.points >= least_points,
                 "{} points on the curve: this parameter choice needs at least {}", options_.points,
                 least_points);
  MODCAL_REQUIRE(std::isnan(options_.lowest) || options_.lowest > 0.0,
                 "lowest parameter {:g} searched: a logarithmic range needs one > 0",
                 options_.lowest);
  MODCAL_REQUIRE(std::isnan(options_.highest) || std::isfinite(options_.highest),
                 "highest parameter {:g} searched must be finite", options_.highest);
}

ChosenParameter ParameterChoice::choose(const Regularizer& regularizer,
                                        const SpectralData& data) const {
  const SpectralOperator& problem = *data.problem;
  ChosenParameter result;
  const bool signal = problem.zeros() < problem.size();
  if (!regularizer.has_parameter() || !signal) {
    result.status = ChoiceStatus::kNoParameter;
    result.explanation = signal
                             ? "this regularizer has no parameter to choose"
                             : "every singular value is 0: the data hold nothing of the solution";
    result.point = point_at(0.0, regularizer, data, {});
    result.curve = {result.point};
  } else {
    const std::vector<double> grid = search_grid(falling_penalized_sigma(regularizer, problem));
    result.curve.resize(grid.size());
    regularizer.trace(SpectralSystem(data, measure_), grid, result.curve);
    Pick picked = pick({regularizer, data, measure_, result.curve});
    result.status = picked.status;
    result.explanation = std::move(picked.explanation);
    result.point = point_at(picked.parameter, regularizer, data, result.curve);
  }
  result.kept_share = problem.freedom() > 0.0 ? result.point.freedom / problem.freedom() : 0.0;
  for (std::string warning :
       {warning_of(result), disagreement_of(result, problem.rows(), data.noise_rms)}) {
    if (!warning.empty()) result.warnings.push_back(std::move(warning));
  }
  return result;
}

std::vector<double> ParameterChoice::search_grid(std::span<const double> falling_sigma) const {
  const double largest = falling_sigma.front();
  const double smallest =
      *std::find_if(falling_sigma.rbegin(), falling_sigma.rend(), [](double s) { return s > 0.0; });
  const double highest = std::isnan(options_.highest) ? largest : options_.highest;
  const double lowest = !std::isnan(options_.lowest) ? options_.lowest
                                                     : std::max(std::min(smallest, highest),
                                                                kLowestParameterShare * highest);
  MODCAL_REQUIRE(lowest <= highest,
                 "no parameter to search: the lowest, {:g}, exceeds the highest, {:g} (singular "
                 "values lie in [{:g}, {:g}])",
                 lowest, highest, smallest, largest);
  const bool one_value = lowest == highest && options_.points > 0;
  std::vector<double> grid(one_value ? 1 : static_cast<std::size_t>(options_.points));
  const double intervals = std::max(1.0, static_cast<double>(grid.size()) - 1.0);
  const double step = std::log(highest / lowest) / intervals;
  for (std::size_t j = 0; j < grid.size(); ++j) {
    grid[j] = lowest * std::exp(step * static_cast<double>(j));
  }
  if (grid.size() > 1) grid.back() = highest;
  return grid;
}

CurvePoint ParameterChoice::point_at(double parameter, const Regularizer& regularizer,
                                     const SpectralData& data,
                                     std::span<const CurvePoint> curve) const {
  for (const CurvePoint& point : curve) {
    if (point.parameter == parameter) return point;
  }
  CurvePoint point;
  regularizer.trace(SpectralSystem(data, measure_), std::span(&parameter, 1), std::span(&point, 1));
  return point;
}

ParameterChoice::Pick ParameterChoice::smallest_criterion(std::span<const CurvePoint> curve,
                                                          std::string_view what) {
  const CurvePoint* best = nullptr;
  const CurvePoint* first = nullptr;
  const CurvePoint* last = nullptr;
  for (const CurvePoint& point : curve) {
    if (std::isnan(point.criterion)) continue;
    if (!first) first = &point;
    last = &point;
    if (!best || point.criterion < best->criterion) best = &point;
  }
  if (!best) {
    return {curve.front().parameter, ChoiceStatus::kNotReached,
            fmt::format("{} is not defined on the searched range; the lowest parameter stands in",
                        what)};
  }
  if (best == first || best == last) {
    return {best->parameter, ChoiceStatus::kEdgeOfRange,
            fmt::format("smallest {} at the {} edge {:.4g} of the searched range", what,
                        best == first ? "lower" : "upper", best->parameter)};
  }
  return {best->parameter, ChoiceStatus::kChosen,
          fmt::format("smallest {} {:.4g} at {:.4g}", what, best->criterion, best->parameter)};
}

std::string disagreement_of(const ChosenParameter& choice, std::size_t rows, double noise_rms) {
  if (choice.status != ChoiceStatus::kChosen) return {};
  const double data = static_cast<double>(rows);
  std::vector<CurvePoint> curve = choice.curve;
  const std::pair<const char*, Pick> others[] = {
      {"generalized cross validation", cross_validation_on(curve, data)},
      {"the minimal product", minimal_product_on(curve)},
      {"the discrepancy principle", discrepancy_on(curve, noise_rms * std::sqrt(data))}};
  std::string text;
  for (const auto& [name, other] : others) {
    // At the edge of where a criterion is defined may still be inside the range.
    const bool inside =
        other.parameter > curve.front().parameter && other.parameter < curve.back().parameter;
    if (other.status != ChoiceStatus::kChosen &&
        (other.status != ChoiceStatus::kEdgeOfRange || !inside)) {
      continue;
    }
    const double ratio = other.parameter / choice.parameter();
    if (ratio <= kRulesApart && ratio * kRulesApart >= 1.0) continue;
    text += fmt::format("{}{} {:.3g}", text.empty() ? "" : ", ", name, other.parameter);
  }
  if (text.empty()) return {};
  return fmt::format("the rules disagree: {:.3g} was chosen where others would take: {}",
                     choice.parameter(), text);
}

}  // namespace modcal
