// A report laid out like the paper's figures, from closed formulas: what the tests write and what a
// browser is shown.
#pragma once

#include <numbers>

#include "experiments/report/report.hpp"

namespace modcal::report {

/// 3 × 2 waveforms of 20 ms (1024 samples), identified from the left and the right reaction.
Figure waveform_figure();
/// 4 × 3 objective functions of the first twelve modes, the true frequency dotted.
Figure objective_figure();
/// Correlation against noise with bands and the paper's values as points.
Figure noise_figure();
/// L-curve, product curve on logarithmic axes, with values such axes cannot show.
Figure curve_figure();
/// One second at 51.2 kHz, a curve that turns back, bars at points and a panel without data.
Figure long_figure();
Table noise_table();

Report sample_report();

}  // namespace modcal::report
