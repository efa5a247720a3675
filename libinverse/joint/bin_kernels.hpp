// Loops over the bins of a joint inversion, compiled for every instruction set (Highway).
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "libsim/signal/fft.hpp"

namespace modcal {

/// Per bin, spans of one length: q = Σ_r w_r |H_r|² and, in place of X_0, Σ_r w_r conj(H_r) X_r.
void combine_sides(std::array<double, 2> weight, std::span<const Complex> transfer0,
                   std::span<const Complex> transfer1, std::span<const Complex> spectrum1,
                   std::span<Complex> spectrum0, std::span<double> gain);

/// Per bin |X_0 H_1 − X_1 H_0|² scale/(v_0 |H_1|² + v_1 |H_0|²), 1 where both H are 0: 1 on average
/// where nothing but noise of variances v parts the sides. Returns the sum.
double cross_misfit(std::array<double, 2> noise_variance, double scale,
                    std::span<const Complex> transfer0, std::span<const Complex> transfer1,
                    std::span<const Complex> spectrum0, std::span<const Complex> spectrum1,
                    std::span<double> misfit);

/// Per bin: power |d|² · scale.
void scaled_power(std::span<const Complex> data, double scale, std::span<double> power);

/// What the curve of evidence needs of a bin of two degrees of freedom: g = q P scale,
/// m u = 2 power/q and m |x|² = 2 power/q², all 0 where q is 0.
void evidence_terms(std::span<const double> gain, std::span<const double> prior,
                    std::span<const double> power, double scale, std::span<double> g,
                    std::span<double> reduced, std::span<double> solution);

/// E|F|² given the data, in place of the prior variance P: power p² + p with p = P/(1 + q P).
void expected_power(std::span<const double> gain, std::span<const double> power,
                    std::span<double> prior);

/// p = P/(1 + q P) in place of P and d p in place of d. Returns Σ q p.
double apply_posterior(std::span<const double> gain, std::span<double> prior,
                       std::span<Complex> data);

/// out = H x. Returns Σ |H|² p.
double through_transfer(std::span<const Complex> transfer, std::span<const Complex> data,
                        std::span<const double> variance, std::span<Complex> out);

}  // namespace modcal
