// Moments and comparisons of sample sequences.
#pragma once

#include <span>
#include <vector>

namespace modcal {

double mean(std::span<const double> x);
/// Standard deviation about the mean, divisor n.
double standard_deviation(std::span<const double> x);
/// Correlation coefficient σ_xy/(σ_x σ_y) (Debut, Delaune and Antunes, 2010, eq. 16). NaN where one
/// of the two is constant. Throws InvalidInput where the lengths differ or are 0.
double correlation(std::span<const double> x, std::span<const double> y);
/// ‖x − y − mean(x − y)‖ / ‖y − mean(y)‖: rms error relative to the reference y, static parts
/// removed. NaN where y is constant.
double relative_rms_error(std::span<const double> x, std::span<const double> y);
/// max |x|, 0 without samples; NaN is passed over.
double largest_magnitude(std::span<const double> x);
void remove_mean(std::span<double> x);
/// Quantile q in [0, 1] with linear interpolation between order statistics (Hyndman and Fan, 1996,
/// type 7). NaN for an empty sample.
double quantile(std::vector<double> values, double q);
/// 97.5 % quantile of Student's t with so many degrees of freedom, to 1 %; 0: of the normal
/// distribution (Cornish and Fisher's expansion; Abramowitz and Stegun, 1964, eq. 26.7.5).
double student_quantile(std::size_t degrees);

}  // namespace modcal
