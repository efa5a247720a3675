// The first zero of a power series: how switches are located.
#pragma once

#include <optional>
#include <span>

namespace modcal::event {

/// First θ in (0, upper] at which p(θ) = Σ c_m θ^m, p(0) > 0, falls to zero; nothing where p stays
/// positive. `starts_at_zero`: p(0) = 0 is known, that root does not count and the first non-zero
/// derivative decides (a negative one: θ = 0).
///
/// The march never passes the first zero: with p''(t) ≥ p''(θ) − M₃(upper − θ), M₃ ≥ |p'''|, the
/// parabola below p is positive up to its own first root, which is the next θ. Near a simple root
/// this is Newton's method from the left.
std::optional<double> first_crossing(std::span<const double> coefficients, double upper,
                                     bool starts_at_zero);

}  // namespace modcal::event
