#include "libinverse/modes/stabilization.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using Points = std::vector<StabilizationPoint>;

/// The pole of an earlier order that this one continues; null where there is none.
const StabilizationPoint* predecessor(const Points& earlier, const DecayPole& pole,
                                      const StabilizationOptions& options) {
  const StabilizationPoint* nearest = nullptr;
  double distance = options.frequency_tolerance * pole.frequency;
  for (const StabilizationPoint& point : earlier) {
    const double apart = std::abs(point.pole.frequency - pole.frequency);
    if (apart > distance) continue;
    if (std::abs(point.pole.damping_ratio - pole.damping_ratio) > options.damping_tolerance) {
      continue;
    }
    distance = apart;
    nearest = &point;
  }
  return nearest;
}

Points of_order(const Points& diagram, std::size_t order) {
  Points row;
  std::copy_if(diagram.begin(), diagram.end(), std::back_inserter(row),
               [order](const StabilizationPoint& point) { return point.order == order; });
  return row;
}

double deviation_of(const std::vector<double>& values) {
  double mean = 0.0, sum = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

}  // namespace

void StabilizationOptions::visit(OptionVisitor& visitor) {
  visitor.integer({.key = "lowest_order",
                   .meaning = "first order of the realizations; two a mode",
                   .range = Range::closed(2, 1000)},
                  lowest_order);
  visitor.integer({.key = "highest_order",
                   .meaning = "last order of the realizations",
                   .range = Range::closed(2, 1000)},
                  highest_order);
  visitor.number({.key = "frequency_tolerance",
                  .meaning = "largest relative change of a stable frequency between orders",
                  .unit = "1",
                  .range = Range::positive()},
                 frequency_tolerance);
  visitor.number({.key = "damping_tolerance",
                  .meaning = "largest change of a stable damping ratio between orders",
                  .unit = "1",
                  .range = Range::positive()},
                 damping_tolerance);
  visitor.integer({.key = "required",
                   .meaning = "orders in a row over which a mode must be stable",
                   .range = Range::closed(2, 500)},
                  required);
  visitor.number({.key = "highest_damping",
                  .meaning = "damping ratio above which a pole is taken for none",
                  .unit = "1",
                  .range = Range::open(0.0, 1.0)},
                 highest_damping);
}

std::vector<StabilizationPoint> stabilization_diagram(const EigensystemRealization& realization,
                                                      const StabilizationOptions& options) {
  const auto last = std::min<std::size_t>(static_cast<std::size_t>(options.highest_order),
                                          realization.highest_order());
  Points diagram, earlier;
  for (auto order = static_cast<std::size_t>(options.lowest_order); order <= last; order += 2) {
    Points row;
    for (const DecayPole& pole : realization.poles(order)) {
      if (!(pole.damping_ratio > 0.0 && pole.damping_ratio < options.highest_damping)) continue;
      const StabilizationPoint* before = predecessor(earlier, pole, options);
      row.push_back({order, pole, before ? before->stable_orders + 1 : 1});
    }
    diagram.insert(diagram.end(), row.begin(), row.end());
    earlier = std::move(row);
  }
  return diagram;
}

std::vector<StablePole> stable_poles(const std::vector<StabilizationPoint>& diagram,
                                     const StabilizationOptions& options) {
  MODCAL_REQUIRE(options.required >= 2, "{} orders in a row say nothing: take at least 2",
                 options.required);
  std::vector<StablePole> stable;
  if (diagram.empty()) return stable;
  const std::size_t last = diagram.back().order;
  for (const StabilizationPoint& point : of_order(diagram, last)) {
    if (point.stable_orders < options.required) continue;
    std::vector<double> frequencies = {point.pole.frequency};
    std::vector<double> ratios = {point.pole.damping_ratio};
    StabilizationPoint current = point;
    while (current.stable_orders > 1) {
      const Points earlier = of_order(diagram, current.order - 2);
      current = *predecessor(earlier, current.pole, options);
      frequencies.push_back(current.pole.frequency);
      ratios.push_back(current.pole.damping_ratio);
    }
    stable.push_back({point.pole, {deviation_of(frequencies), deviation_of(ratios)}});
  }
  return stable;
}

}  // namespace modcal
