// Constants that were tuned, not derived. Records: violin G, 1 s, bowed, thermal friction, 5 % of
// noise (benchmarks/truth): one polarization (N), a second one of 10 % alike at both ends (A).
#pragma once

namespace modcal {

/// Prior sd of the share of a second polarization at either end [1]: what a record cannot tell of
/// one is in its deviations.
/// Source: a bow that is moved by hand turns the string's motion by a few degrees.
/// Range tried: 0.015 to 0.06.
/// Doubled: deviations of f_4 in N 3.6e-5 (3.2e-5, without 2.7e-5), an f_n of A off by 4.2 of its own (5.0).
/// Halved: 2.9e-5 in N, 5.5 in A.
constexpr double kPolarizationWidth = 0.03;

}  // namespace modcal
