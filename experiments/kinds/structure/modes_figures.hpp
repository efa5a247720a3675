// Figures of modes that were fitted.
#pragma once

#include "experiments/report/report.hpp"
#include "libinverse/structure/strikes/strike_fit.hpp"

namespace modcal {

/// BIC over the number of modes.
report::Figure criterion_figure(const StrikeFit& fit);
/// Poles over the number of modes, those apart that stay when one is added.
report::Figure stabilization_figure(const StrikeFit& fit);
/// Responses over force, measured and of the model.
report::Figure responses_figure(const StrikeFit& fit);

}  // namespace modcal
