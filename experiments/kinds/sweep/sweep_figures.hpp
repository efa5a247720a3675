// Correlation against noise, drawn.
#pragma once

#include <string>
#include <vector>

#include "experiments/kinds/sweep/sweep_rows.hpp"
#include "experiments/report/figure.hpp"

namespace modcal {

/// A panel a side; where several estimators are compared, every estimate in one panel, for the
/// short windows and for the long one.
report::Figure correlation_figure(const std::string& name, const std::vector<SweepRow>& rows,
                                  const std::string& command);

}  // namespace modcal
