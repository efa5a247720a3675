// Kind "calibrate": refine the modal model by an objective, then identify with it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/kinds/calibrate/calibrate_plucks.hpp"
#include "experiments/kinds/invert/invert_study.hpp"
#include "experiments/study/observation.hpp"
#include "libcalib/calibration.hpp"
#include "libcalib/parameters/stiff_string_fit.hpp"
#include "libinverse/estimator.hpp"

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
                                     std::span<const CalibrationRecord> plucks = {});

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

/// Players for force and string velocity at the contact: the true ones where they are known, those
/// identified from each reaction and from both with the refined model. At most the first second,
/// low-passed and thinned to a rate near 22 kHz. The truth must have the velocity, if it is there.
report::Audio calibration_audio(const CalibrateOptions& options, const Observation& observation,
                                const AssumedModel& refined);

/// The observation with S = gain exp(−s delay) s/(s + corner) taken out of the reaction at x = L,
/// which had a sensor that a calibration found to differ: R₂ = R₂' / S. The delay is shifted back
/// (see advanced()). A high-pass is undone as y + corner ∫ y dt; without the level that the sensor
/// lost, a line is left over the record, and it is taken out. Equal sensors: unchanged.
Observation with_sensors_alike(Observation observation, const Sensor& sensors);

/// Throws InvalidInput where the estimator is told of sensors that differ and the calibration finds
/// or is told how they do, too: with_sensors_alike() has then taken out what the estimator takes
/// out.
void require_sensors_once(const CalibrationOptions& calibration, const Estimator& estimator);

/// What was taken out, for a report; empty for equal sensors or where x = L was not recorded.
std::string correction_text(const Observation& observation, const Sensor& sensors);

}  // namespace modcal
