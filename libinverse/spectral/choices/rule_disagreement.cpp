#include "libinverse/spectral/choices/rule_disagreement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "libinverse/spectral/problem/interior_minimum.hpp"

namespace modcal {
namespace {

constexpr double kStrong = 10.0;

std::optional<double> of_cross_validation(std::span<const CurvePoint> curve, double rows) {
  std::size_t best = curve.size();
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < curve.size(); ++j) {
    const double left = rows - curve[j].freedom;
    const double quotient = curve[j].residual_norm / left;
    if (!(left > 0.0) || !(quotient < smallest)) continue;
    smallest = quotient;
    best = j;
  }
  if (best == 0 || best + 1 >= curve.size()) return std::nullopt;
  return curve[best].parameter;
}

std::optional<double> of_product(std::span<const CurvePoint> curve) {
  std::vector<double> product(curve.size());
  std::transform(curve.begin(), curve.end(), product.begin(),
                 [](const CurvePoint& p) { return p.residual_norm * p.solution_norm; });
  const auto minimum = most_prominent_minimum(product);
  if (!minimum) return std::nullopt;
  return curve[minimum->index].parameter;
}

std::optional<double> of_discrepancy(std::span<const CurvePoint> curve, double bound) {
  const auto above = std::find_if(curve.begin(), curve.end(),
                                  [bound](const CurvePoint& p) { return p.residual_norm > bound; });
  if (!(bound > 0.0) || above == curve.begin() || above == curve.end()) return std::nullopt;
  return std::prev(above)->parameter;
}

}  // namespace

std::string disagreement_of(const ChosenParameter& choice, std::size_t rows, double noise_rms) {
  if (choice.status != ChoiceStatus::kChosen) return {};
  const double data = static_cast<double>(rows);
  const std::pair<const char*, std::optional<double>> others[] = {
      {"generalized cross validation", of_cross_validation(choice.curve, data)},
      {"the minimal product", of_product(choice.curve)},
      {"the discrepancy principle", of_discrepancy(choice.curve, noise_rms * std::sqrt(data))}};
  std::string text;
  for (const auto& [name, parameter] : others) {
    if (!parameter) continue;
    const double ratio = *parameter / choice.parameter();
    if (ratio <= kStrong && ratio * kStrong >= 1.0) continue;
    text += fmt::format("{}{} {:.3g}", text.empty() ? "" : ", ", name, *parameter);
  }
  if (text.empty()) return {};
  return fmt::format("the rules disagree: {:.3g} was chosen where others would take: {}",
                     choice.parameter(), text);
}

}  // namespace modcal
