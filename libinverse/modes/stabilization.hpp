// Which poles of a realization are modes: those that stay where they are when the order grows.
#pragma once

#include <cstdint>
#include <vector>

#include "libinverse/modes/eigensystem_realization.hpp"
#include "libsim/base/options.hpp"

namespace modcal {

struct StabilizationOptions {
  std::int64_t lowest_order = 2;
  std::int64_t highest_order = 60;
  double frequency_tolerance = 2e-3;  ///< change of f between orders, relative [1]
  double damping_tolerance = 1e-3;    ///< change of ζ between orders, absolute [1]
  std::int64_t required = 6;          ///< orders in a row that a mode must be stable
  double highest_damping = 0.2;       ///< a pole with more is no mode of a string [1]
  void visit(OptionVisitor& visitor);
};

/// One pole of one order.
struct StabilizationPoint {
  std::size_t order = 0;
  DecayPole pole;
  /// Orders in a row, this one included, over which it has moved less than the tolerances.
  std::int64_t stable_orders = 0;
};

/// Poles of the even orders from lowest to highest, or to the highest that the realization has.
std::vector<StabilizationPoint> stabilization_diagram(const EigensystemRealization& realization,
                                                      const StabilizationOptions& options);

/// A pole of the last order that has been stable for as long as required, with the standard
/// deviation of f and ζ over those orders: how far the choice of the order matters, which is not
/// how far noise does.
struct StablePole {
  DecayPole pole;
  DecayPole spread;
};
std::vector<StablePole> stable_poles(const std::vector<StabilizationPoint>& diagram,
                                     const StabilizationOptions& options);

}  // namespace modcal
