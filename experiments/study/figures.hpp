// Figures of simulated and identified records as an experiment asks for them, laid out as the paper
// has them.
#pragma once

#include "experiments/report/figure.hpp"
#include "experiments/study/identification.hpp"

namespace modcal {

/// A signal of a bowed string: its name in figures and files, and where it stands.
struct Quantity {
  std::string_view name;
  std::string_view unit;
  bool OutputRequest::*wanted;
  Signal Simulation::*simulated;
  std::vector<double> InversionResult::*identified;  ///< null: measured, not identified
};
inline constexpr Quantity kQuantities[] = {
    {"y", "m", &OutputRequest::displacement, &Simulation::displacement,
     &InversionResult::displacement},
    {"v", "m/s", &OutputRequest::velocity, &Simulation::velocity, &InversionResult::velocity},
    {"f_c", "N", &OutputRequest::force, &Simulation::force, &InversionResult::force},
    {"R1", "N", &OutputRequest::left_reaction, &Simulation::left_reaction, nullptr},
    {"R2", "N", &OutputRequest::right_reaction, &Simulation::right_reaction, nullptr},
};
/// The one of this name.
const Quantity& quantity_of(std::string_view name);
/// The outputs of these names.
OutputRequest request_of(const std::vector<std::string>& names);

/// Interval of the time axis [s].
struct TimeWindow {
  double start = 0.0;
  double stop = std::numeric_limits<double>::quiet_NaN();
  void visit(OptionVisitor& visitor);
};

/// One figure: what it shows and of which part. Rows are quantities × windows, columns the two
/// ends.
struct FigureOptions {
  std::string id;
  std::string title;
  std::string content = "waveforms";
  std::vector<std::string> quantities = {"y", "v", "f_c"};
  std::vector<TimeWindow> windows;
  std::int64_t modes = 12;
  double lowest_frequency = 20.0;
  double highest_frequency = std::numeric_limits<double>::quiet_NaN();
  void visit(OptionVisitor& visitor);
};

/// Simulated reactions side by side, or the motion at the contact in one column (paper, figs. 2,
/// 3): rows are quantities × windows.
report::Figure simulation_figure(const FigureOptions& options, const Simulation& simulation);

/// Of identified (solid) and true (dotted) signals, one column a side, the waveforms or the moduli
/// of the spectra |X(ω)| (unscaled sum over f_s) (paper, figs. 4–8, 10–12, 15–17); or L-curves
/// (first row) and criterion curves (second row) (figs. 9 and 21).
report::Figure identification_figure(const FigureOptions& options, const Observation& observation,
                                     const std::vector<SideIdentification>& sides);

}  // namespace modcal
