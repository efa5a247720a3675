// Figures of simulated and identified records, laid out as the paper has them.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/report/figure.hpp"
#include "experiments/study/figure_options.hpp"
#include "experiments/study/identification.hpp"

namespace modcal {

/// One curve of a waveform panel.
struct Trace {
  std::string label;
  const std::vector<double>* samples = nullptr;
  report::SeriesStyle style = report::SeriesStyle::kLine;
  report::ColorRole color = report::ColorRole::kFirst;
};

/// What stands in the panel of one quantity ("y", "v", "f_c", "R1", "R2") and one column.
using TraceLookup =
    std::function<std::vector<Trace>(std::string_view quantity, std::size_t column)>;

/// Rows: quantities × windows; columns as labeled.
report::Figure waveform_figure(const FigureOptions& options, double sample_rate, double duration,
                               const std::vector<std::string>& column_labels,
                               const TraceLookup& traces);

/// Moduli of the spectra |X(ω)| (unscaled sum over f_s) of the same traces.
report::Figure spectrum_figure(const FigureOptions& options, double sample_rate,
                               double highest_frequency,
                               const std::vector<std::string>& column_labels,
                               const TraceLookup& traces);

/// L-curves (first row) and criterion curves (second row) of both sides (paper, figs. 9 and 21).
report::Figure parameter_curve_figure(const FigureOptions& options,
                                      const std::vector<SideIdentification>& sides);

/// Simulated reactions side by side, or the motion at the contact in one column (paper, figs. 2,
/// 3).
report::Figure simulation_figure(const FigureOptions& options, const Simulation& simulation);

/// Identified (solid) and true (dotted) signals, one column a side (paper, figs. 4–8, 10–12,
/// 15–17).
report::Figure identification_figure(const FigureOptions& options, const Observation& observation,
                                     const std::vector<SideIdentification>& sides);

}  // namespace modcal
