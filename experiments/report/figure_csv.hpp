#pragma once

#include <string>

#include "experiments/report/figure.hpp"

namespace modcal::report {

/// All samples of a figure as columns: one column of x for every distinct set of abscissae, after
/// it "panel: series [unit]" (and "… low", "… high") for each series over it. Shorter columns end
/// in empty fields; a NaN is "nan". Before them stand the cells of a map, one a row: their middle
/// in x and y and their category.
std::string figure_csv(const Figure& figure);

}  // namespace modcal::report
