// Figures of simulated and identified records as an experiment asks for them, laid out as the paper
// has them.
#pragma once

#include "experiments/report/figure.hpp"
#include "experiments/study/identification.hpp"

namespace modcal {

/// The outputs of these names.
OutputRequest request_of(const std::vector<std::string>& names);

/// Interval of the time axis [s].
struct TimeWindow {
  double start = 0.0;
  double stop = std::numeric_limits<double>::quiet_NaN();
  void visit(OptionVisitor& visitor);
};

/// What a figure draws. In the order of kFigureContents: of signals, of the choice of a parameter,
/// of a search; every kind of experiment has the first ones.
enum class FigureContent { kWaveforms, kSpectra, kParameterCurves, kObjectives, kFrequencyErrors };
inline constexpr std::array<std::string_view, 5> kFigureContents = {
    "waveforms", "spectra", "parameter_curves", "objectives", "frequency_errors"};

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
  FigureContent drawn() const;  ///< throws InvalidInput for another word
  bool draws_signals() const { return drawn() <= FigureContent::kSpectra; }
  bool draws_search() const { return drawn() >= FigureContent::kObjectives; }
};

/// Throws InvalidInput where the window holds nothing of the record; the figure's `id` is named.
void require_inside(const std::string& id, const TimeWindow& window, double duration);
/// The windows of a figure with their ends; all of the record where none is stated. Throws
/// InvalidInput for one that holds nothing of it.
std::vector<TimeWindow> windows_or_all(const FigureOptions& options, double duration);

/// Simulated reactions side by side, or the motion at the contact in one column (paper, figs. 2,
/// 3): rows are quantities × windows.
report::Figure simulation_figure(const FigureOptions& options, const Simulation& simulation);

/// Of identified (solid) and true (dashed) signals, one column a side, the waveforms or the moduli
/// of the spectra |X(ω)| (unscaled sum over f_s) (paper, figs. 4–8, 10–12, 15–17); or L-curves
/// (first row) and criterion curves (second row) (figs. 9 and 21).
report::Figure identification_figure(const FigureOptions& options, const Observation& observation,
                                     const std::vector<SideIdentification>& sides);

/// What every identification shows unasked: the force with its 95 % band, the motion, the force
/// over the velocity, the spectra of reactions and force with the noise of the sensors, and what
/// both reactions contradict each other by. The estimates must have all three signals.
std::vector<report::Figure> overview_figures(const Observation& observation,
                                             const std::vector<SideIdentification>& sides);

}  // namespace modcal
