// Kind "calibrate": refine the modal model by an objective, then identify force and motion with it;
// and the limit of a calibration, which `modcal limit` can state.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "experiments/kinds/calibrate/calibrate_structure.hpp"
#include "experiments/kinds/invert/invert.hpp"
#include "libcalib/calibration.hpp"
#include "libcalib/identifiability/expected_limit.hpp"
#include "libcalib/parameters/stiff_string_fit.hpp"

namespace modcal {

/// What is simulated and what a calibration of it frees.
struct LimitQuestion {
  static constexpr double kLawWidth = 2e-3;  ///< τ where it is to be estimated

  ObservationOptions observation;
  double noise_level = 0.01;               ///< of every stroke
  std::vector<double> further_contacts;    ///< x_c of further strokes of the scene [m]
  std::vector<ObservationOptions> plucks;  ///< with noise levels of their own
  double highest_frequency = std::numeric_limits<double>::quiet_NaN();  ///< [Hz]; NaN: automatic
  double law_width = kLawWidth;  ///< τ of the prior of f_n about the law
  UnknownsOptions unknowns;

  /// Takes the band, τ and the unknowns of a calibration.
  void calibrate_by(const CalibrationOptions& calibration);
};

/// The records of the question without noise, simulated through the cache, and the bounds. Throws
/// InvalidInput for a record: the truth has to be simulated. `outputs`: what the first stroke is
/// simulated with beside its reactions, where somebody else asks for them too.
LimitCase limit_case(const LimitQuestion& question, TruthCache& truths, OutputRequest outputs = {});

/// The standard deviation to expect of every parameter, a verdict for each mode, and contact points
/// that remove blind modes. Throws InvalidInput for a record: the truth has to be simulated.
std::string limit_text(const LimitQuestion& question, TruthCache& truths);
/// The numbers of it.
nlohmann::ordered_json limit_json(const LimitQuestion& question, TruthCache& truths);

// Plucks that a calibration fits together with its strokes.

struct SearchTask;

/// Keys of a simulated pluck.
void visit_pluck(OptionVisitor& visitor, Choice<InitialMotion>& start, double& duration,
                 double& noise_level);

/// One pluck of the string that is calibrated: simulated, the scene without its bow, or a recorded
/// file laid out as that of the stroke, which begins when the string has been let go.
struct PluckRecordOptions {
  Choice<InitialMotion> start{"rest"};  ///< a simulated one needs to be plucked
  double duration = 1.0;                ///< [s]
  double noise_level = 0.01;            ///< of a simulated pluck [1]
  double sample_rate = 51200.0;         ///< of a simulated pluck [Hz]
  std::string file;                     ///< empty: simulated
  /// Noise standard deviation of each reaction [N]; NaN: estimated from the record.
  double left_noise = std::numeric_limits<double>::quiet_NaN();
  double right_noise = std::numeric_limits<double>::quiet_NaN();
  void visit(OptionVisitor& visitor);
  /// As an observation: the scene of the first stroke without its bow, or the other file.
  ObservationOptions observation(const ObservationOptions& first) const;
};

/// Throws InvalidInput with the first of these.
void require_plucks(const std::vector<PluckRecordOptions>& plucks, const ObservationOptions& first,
                    const CalibrationOptions& calibration);

/// The reactions of every pluck, simulated (through the cache) or read; noise of their own.
std::vector<CalibrationRecord> observe_plucks(const std::vector<PluckRecordOptions>& plucks,
                                              const ObservationOptions& first, const StreamKey& key,
                                              const StudyContext& context);

/// Further strokes of the same string, fitted together with the first: simulated ones at further
/// contact points, or further recorded files laid out as the first.
struct FurtherStrokes {
  std::vector<double> contacts;    ///< x_c [m]
  std::vector<std::string> files;  ///< relative to the folder of the experiment's file
  void visit(OptionVisitor& visitor);
  /// Throws InvalidInput where they do not fit to what is calibrated.
  void require_fit_to(const ObservationOptions& first, const CalibrationOptions& calibration) const;
};

/// Where lints say what stands against the optimizer.
inline constexpr const char* kOptimizerPath = "calibration.optimizer";

struct CalibrateOptions {
  static constexpr std::string_view kForStructures =
      "state structure: {table: modes.yaml, record: {file: ..., responses: [{channel: ...}]}}";
  bool has_structure = false;  ///< nothing below `structure` is read then
  StructureCalibrationOptions structure;
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
  std::vector<Finding> lint() const;
  std::vector<Finding> lint_records(const std::filesystem::path& folder) const;
  std::vector<PlanLine> plan() const;
  std::optional<PlannedSimulations> planned_simulations() const;
  std::vector<FileRead> files_read() const;
  LimitQuestion limit_question() const;
  std::unique_ptr<const SearchTask> search_task(const StudyContext& context) const;
  StudyResult run(const StudyContext& context) const;
  std::vector<Finding> lint_structure() const;
};

/// Whether the model of a record starts from what its ends tell: nothing is stated to be known.
bool starts_from_record(const CalibrationOptions& calibration);

/// Every record of a calibration, the stroke that is identified first.
struct ObservedRecords {
  std::vector<Observation> strokes;
  std::vector<CalibrationRecord> plucks;
};
/// Throws InvalidInput where one is a copy of another, which would count twice.
void require_different_strokes(const std::vector<Observation>& strokes);
/// Throws WrongKey where no stroke tells the string: each was made in its middle.
void require_told_string(const ObservationOptions& first, std::span<const Observation> strokes);
/// Simulates or reads them. `outputs`: what the first stroke is simulated with.
ObservedRecords observe_records(const CalibrateOptions& options, const OutputRequest& outputs,
                                const StudyContext& context);

/// The search of a calibration, before it is begun. Of a schedule of stages the function holds what
/// is known beforehand, too (with_priors()).
struct SearchTask {
  BoundProblem bound;
  std::shared_ptr<const Optimizer> optimizer;
  Budget budget;
  /// Of a simulated string, values of the free parameters where its model is right; else empty.
  std::vector<double> truth;
  /// Of a simulated string, its records without noise, with the deviations of that, and its model;
  /// no records where there is no noise.
  std::optional<Problem> clean;
  /// Standard deviations at the truth by the information of both reactions with the force unknown,
  /// all else known, and by what is known beforehand: no unbiased estimate from these records that
  /// knows no more goes below, whatever its objective. 0 where there is no noise, ∞ of what the
  /// records do not tell; empty without a truth.
  std::vector<double> bound_deviations() const;
};

/// A calibration together with what it is judged by.
struct CalibrationOutcome {
  AssumedModel initial;
  AssumedModel refined;
  CalibrationResult result;
  std::optional<StiffStringFit> law;  ///< where blind modes were filled
  std::string start;  ///< where the record told another start than the one stated, and which
  bool contact_untold = false;           ///< the ends do not tell x_c: it started as stated
  std::vector<double> true_frequencies;  ///< [Hz]; empty for a record

  /// Whether ζ_n of some mode was free.
  bool frees_damping_of_modes() const {
    return std::ranges::any_of(result.parameters,
                               [](const auto& one) { return one.name.starts_with("zeta_"); });
  }
  /// Table of the parameters, f_n and ζ_n aside.
  void visit_parameters(ResultVisitor& visitor) const;
  /// The parameters but frequencies and damping ratios of single modes.
  std::vector<CalibratedParameter> beside_modes() const;
  /// All other tables of the report, and calibration.json.
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

/// Spectra of the reactions that were observed.
CalibrationData calibration_data(const Observation& observation);

/// Clock that ends a search with Interrupted where the context says so.
SecondsClock polling_clock(const StudyContext& context);

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
/// |f_n − true|/true of the excited modes, of the initial model or the refined one; empty without a
/// truth.
std::vector<double> frequency_errors(const CalibrationOutcome& outcome, bool initial = false);

/// Median of |f_n − true|/true over the modes that were searched; NaN without a truth.
double median_relative_error(const CalibrationOutcome& outcome);

/// Players for force and string velocity at the contact: the true ones where they are known, those
/// identified from each reaction and from both with the refined model. At most the first second,
/// low-passed and thinned to a rate near 22 kHz. The truth must have the velocity, if it is there.
report::Audio calibration_audio(const CalibrateOptions& options, const Observation& observation,
                                const AssumedModel& refined);

/// The frequencies found against their law, and the ratio of the reactions, which no force changes,
/// against the models'. Of a search with an estimate.
std::vector<report::Figure> calibration_overview(const CalibrationOutcome& outcome,
                                                 const Observation& observation,
                                                 const StringSupport& support);

/// r_ij of every two parameters of the law; where that does not hold, of what is of no mode and of
/// the modes that are bound most tightly; shaded by |r_ij|. Without rows for one parameter.
report::Table correlation_map(const ContinuationResult& found);

// What a calibration says in a few lines.

// Columns of the table of parameters that the page shows in its own units.
inline constexpr std::string_view kInitialKey = "initial", kFinalKey = "final",
                                  kDeviationKey = "sd", kUnitKey = "unit";

/// The parameters of visit_parameters() as a report shows them: lengths in mm, values to two digits
/// of their deviation; the files keep SI units and all digits.
std::vector<report::Table> parameter_tables(const CalibrationOutcome& outcome);

/// A value to two digits of its deviation; to six of its own where that is not known.
std::string to_deviation(double value, double deviation);

/// The law and the contact with 95 %, the modes identified and the verdict, in a sentence, of a
/// calibration that is not refused; of a search without an estimate the values alone.
std::string calibration_answer(const CalibrationOutcome& outcome);

/// Adds the search, its parameters with standard deviations, and the verdicts of the fit.
void add_calibration_summary(const CalibrationOutcome& outcome, StudyResult& result);

/// The task fails, by this reason.
void reject_calibration(const std::string& reason, StudyResult& result);

/// Warns of bounds that were reached, of blind modes and of a search that failed, which fails the
/// task.
void add_calibration_warnings(const CalibrationOutcome& outcome, StudyResult& result);

/// What χ² says of a continuation's fit, in words.
std::string chi2_text(const ContinuationResult& found);

/// What of the law, the contact and everything free has no deviation, by name; empty: nothing.
std::string unknown_values(const ContinuationResult& found);

/// What contradicts a result that is not right: χ², the priors stated, a cause of misfit, or
/// several of them; else empty.
std::string contradiction(const CalibrationResult& result);

/// The f0 or x_c that lies beyond the bound of its range, with the remedy: more than three
/// deviations from its start, which tell it better than the bounds; empty: none does.
std::string held_back(const CalibrationResult& result);

/// What is in the record beside what was stated: sensors, damping, causes of misfit; or which of
/// these were looked for; empty where none was. Of a search with an estimate.
std::string cause_lines(const CalibrationResult& result);
/// The cause that contradicts a fit and what to do about it; empty: none.
std::string cause_contradiction(const ContinuationResult& found);
/// The tests as a table.
void visit_causes(ResultVisitor& visitor, const ContinuationResult& found);
/// What the fit leaves over the band, the modes marked; without panels where it was not looked at.
report::Figure misfit_figure(const ContinuationResult& found);

/// The strongest correlations among the parameters that the data identify. A frequency that the law
/// or a prior holds moves with the others by that alone.
std::vector<CorrelatedPair> tightest_pairs(const ContinuationResult& found);

/// The law's parameters with correlations and condition number, as `modcal limit` has them; where
/// every frequency is free the strongest correlations of what the data identify, too.
std::string covariance_text(const ContinuationResult& found);

// Standard deviations and correlations in lines of text.

/// "m", "(factor)" of the damping; empty where a parameter has no unit.
std::string shown_unit(const std::string& parameter);

/// "correlations f0 +0.31 B -0.72": with the first parameters of `names`, one number each.
std::string correlations_with(const std::vector<std::string>& names,
                              const std::vector<double>& correlations);

/// One line a parameter: name, standard deviation, unit, correlations with those before it.
std::string correlation_lines(const NamedCovariance& covariance);

}  // namespace modcal
