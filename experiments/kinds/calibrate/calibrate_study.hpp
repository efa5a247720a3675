// Kind "calibrate": refine the modal model by an objective, then identify with it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/kinds/calibrate/calibrate_plucks.hpp"
#include "experiments/kinds/invert/invert_study.hpp"
#include "libcalib/calibration.hpp"
#include "libcalib/parameters/stiff_string_fit.hpp"

namespace modcal {

/// Further strokes of the same string, fitted together with the first: simulated ones at further
/// contact points, or further recorded files laid out as the first.
struct FurtherStrokes {
  std::vector<double> contacts;    ///< x_c [m]
  std::vector<std::string> files;  ///< relative to the folder of the experiment's file
  void visit(OptionVisitor& visitor);
  /// Throws InvalidInput where they do not fit to what is calibrated.
  void require_fit_to(const ObservationOptions& first, const CalibrationOptions& calibration) const;
};

struct CalibrateOptions {
  InvertOptions inversion;
  CalibrationOptions calibration;
  FurtherStrokes further;
  std::vector<PluckRecordOptions> plucks;
  /// Give blind modes the frequencies of the stiff-string law fitted to the others (paper, eq. 18
  /// and section 7.1).
  bool fill_blind_modes = false;
  bool audio = false;  ///< players in the report
  void visit(OptionVisitor& visitor);
  std::int64_t& seed_slot() { return inversion.seed; }
};

/// A calibration together with what it is judged by.
struct CalibrationOutcome {
  AssumedModel initial;
  AssumedModel refined;
  CalibrationResult result;
  std::optional<StiffStringFit> law;     ///< where blind modes were filled
  std::vector<double> true_frequencies;  ///< [Hz]; empty for a record

  /// Tables of the report and calibration.json.
  void visit(ResultVisitor& visitor) const;
};

CalibrationOutcome calibrate_observation(const CalibrateOptions& options,
                                         const Observation& observation,
                                         SecondsClock clock = steady_seconds());

/// The same from several strokes and plucks; the first stroke is the one that is identified.
CalibrationOutcome calibrate_strokes(const CalibrateOptions& options,
                                     std::span<const Observation> strokes,
                                     SecondsClock clock = steady_seconds(),
                                     std::span<const PluckRecord> plucks = {});

/// f_n of all modes [Hz].
std::vector<double> frequencies_of(const ModalBasis& basis);

/// Spectra of the reactions that were observed.
CalibrationData calibration_data(const Observation& observation);

/// Clock that ends a search with Interrupted where the context says so.
SecondsClock polling_clock(const StudyContext& context);

StudyResult calibrate_study(const CalibrateOptions& options, const StudyContext& context);

/// Where a mode's frequency comes from and why: "from the law (node)".
std::string verdict_text(const ModeVerdict& mode);
/// What a stage's fit says of the priors; empty where none was stated.
std::string prior_lines(const PriorMisfit& misfit, std::string_view stage);

/// Objective over the candidates of the first modes, initial, chosen and true value marked (paper,
/// figs. 13 and 20).
report::Figure objective_figure(const FigureOptions& options, const CalibrationOutcome& outcome);
/// Absolute and relative error of the frequencies and the mode shape at the contact (paper, fig.
/// 14).
report::Figure frequency_error_figure(const FigureOptions& options,
                                      const CalibrationOutcome& outcome);
/// Median of |f_n − true|/true over the modes that were searched; NaN without a truth.
double median_relative_error(const CalibrationOutcome& outcome);

}  // namespace modcal
