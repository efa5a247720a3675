// Measured lines of a response function on another contour and between them.
#pragma once

#include "libinverse/structure/structure_record.hpp"

namespace modcal {

/// First line that is known: what stands below it is NaN.
double first_line_of(const std::vector<Complex>& values);

/// Impulse response over [0, 1/Δf), finer than the lines ask for. Lines below the first one are
/// continued as s^p, those above the last one as its value, which fades out far from the band.
/// Throws InvalidInput for a line between that is not finite.
std::vector<double> impulse_response(const std::vector<Complex>& values, SensorKind kind);

/// H on a contour to the right of its lines': the impulse response is weighted by exp(−δ|t|), δ the
/// distance of the contours (Poisson's integral). It is zero outside of 1/Δf = T, so that its
/// spectrum eight times as fine is smooth (Lagrange's polynomial of eight points about a bin is
/// right to 1e-5). What lies above the last line rings before t = 0 by its cut: the last eighth of
/// T stands there.
class FunctionContour {
 public:
  /// Both must outlive this. Throws InvalidInput for a contour to the left of the lines'.
  FunctionContour(const FrequencyGrid& grid, const ContourSpectra& spectra);

  /// H at the bins of the spectra.
  std::vector<Complex> of(const std::vector<Complex>& values, SensorKind kind) const;

  /// What noise of the lines, each by itself, has at the bins: Σ_l v_l (|K(ω − ω_l)|² + |K(ω +
  /// ω_l)|²), K(ω) = (1 − exp(−(δ + iω)7T/8))/((δ + iω)T) + (1 − exp(−(δ − iω)T/8))/((δ − iω)T).
  std::vector<double> variance_of(const std::vector<double>& of_lines) const;

  double decay() const { return decay_; }  ///< δ [1/s]

 private:
  double duration() const;
  double kernel_power(double omega) const;
  const FrequencyGrid& grid_;
  const ContourSpectra& spectra_;
  double decay_;
};

}  // namespace modcal
