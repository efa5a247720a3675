// Which samples of a long series are worth drawing.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace modcal::report {

/// Indices, growing, of the samples to draw when [x_0, x_last] is `columns` ≥ 1 pixels wide: in
/// every column the smallest `low`, the largest `high` and one NaN if there is any (a gap stays a
/// gap), and the first and the last sample. All samples where there are at most 4 per column on
/// average. x: monotonic (columns of equal width, in log x if `logarithmic`) or not (columns of
/// equal numbers of samples). low, high: as long as x; the samples themselves where there is no
/// spread.
std::vector<std::size_t> drawn_samples(std::span<const double> x, std::span<const double> low,
                                       std::span<const double> high, std::size_t columns,
                                       bool logarithmic);

}  // namespace modcal::report
