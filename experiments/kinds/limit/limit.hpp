// Kind "calibration_limit": calibration error over noise beside the Cramér–Rao bound.
#pragma once

#include "experiments/kinds/axis_experiment.hpp"
#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/kinds/simulate/structure_scene.hpp"

namespace modcal {

/// Bounds by which an error is that of another minimum, not of noise.
inline constexpr double kFailure = 7.8;

/// A bow on any structure, whose modes are refined without the force.
struct StructureLimitOptions : StructureSceneOptions {
  StructureChangeOptions change;
  void visit(OptionVisitor& visitor);
};

struct CalibrationLimitOptions {
  static constexpr std::string_view kForStructures =
      "state structure: {table: modes.yaml, bow: ..., friction: ...} in the place of scene:";
  ObservationOptions observation;
  bool has_structure = false;
  StructureLimitOptions structure;  ///< in the place of a string
  /// Bounds of the start's errors: uniform and independent, x_c included.
  ModelErrorOptions model_error;
  CalibrationOptions calibration = calibration_to_the_bound();
  std::vector<double> noise_levels = {0.001, 0.003, 0.01, 0.02, 0.05, 0.08, 0.1};
  std::int64_t seeds = 50;
  std::int64_t seed = 1;
  bool known_noise = true;   ///< the calibration is told the noise level, where there is any
  bool paper_method = true;  ///< the spectral-peak search from the same starts beside it
  /// Identify the force with the calibrated model and compare it with the true one.
  bool has_inversion = false;
  InversionOptions inversion;
  void visit(OptionVisitor& visitor);
};

/// One calibration of one noise draw, scored on the truth.
struct LimitOutcome {
  std::string failure;
  std::array<double, 4> law{}, law_deviation{};  ///< f_0 [Hz], B, x_c [m], damping factor
  std::vector<double> frequencies, deviations;   ///< of every mode [Hz], relative
  double contact = 0.0, contact_deviation = 0.0;
  /// Gain, delay [s] and corner [Hz] of the sensor at x = L, and standard deviations (0: not free).
  std::array<double, Sensor::kCount> sensors{1.0}, sensor_deviation{};
  double law_chi2 = 0.0, chi2 = 0.0;
  double chi2_deviation = 0.0;  ///< of χ², as the calibration states it
  bool fits = false;            ///< χ² does not contradict it
  bool priors_hold = true;      ///< nor do the data the priors stated
  bool right() const { return fits && priors_hold; }
  double paper_error = 0.0;  ///< median relative error of the paper's method; NaN: not run
  /// Of the force identified with the calibrated model, from 10 % to 95 % of the record; NaN: not
  /// asked for.
  double force_correlation = 0.0;
  void visit(ResultVisitor& visitor);
};

/// Outcomes of one noise level.
struct LimitLevel {
  double noise_level = 0.0;
  std::vector<LimitOutcome> outcomes;
};

/// The bound of one noise level.
LimitQuestion limit_question_of(const CalibrationLimitOptions& options, double noise_level);

/// Adds tables, figure and acceptance to a result that knows how many failed; reads the truth and
/// the bound from the scene.
void sum_up_limit(const CalibrationLimitOptions& options, const std::vector<LimitLevel>& levels,
                  const StudyContext& context, StudyResult& result);

/// Clean reactions of the scene with the noise expected at a level; at zero the noise a calibration
/// takes the aliases of clean records for.
struct LimitTruth {
  ModelPoint point;
  NoisyRecords records;
  std::shared_ptr<const Truth> simulated;
};
LimitTruth limit_truth(const ObservationOptions& observation, double noise_level,
                       TruthCache& truths, OutputRequest outputs = {});

/// Noise levels by seeds.
std::vector<SweepAxis> axes_of(const CalibrationLimitOptions& options);
/// Levels that are there, each once.
void lint_levels(const std::vector<double>& levels, std::vector<Finding>& findings);

/// Kind "calibration_limit" of a string; that of a structure is StructureLimitExperiment.
class CalibrationLimitExperiment final : public ProductExperiment {
 public:
  using Options = CalibrationLimitOptions;
  explicit CalibrationLimitExperiment(Options options);
  std::string_view for_structures() const override { return Options::kForStructures; }
  std::vector<Finding> lint() const override;
  std::vector<PlanLine> plan() const override;
  std::optional<PlannedSimulations> planned_simulations() const override;
  std::shared_ptr<const LimitQuestion> limit_question() const override;

  std::string fingerprint(std::size_t task, const std::filesystem::path& folder) const override;
  std::string run_task(std::size_t task, const StudyContext& context) const override;
  StudyResult sum_up(const TaskOutcomes& outcomes, const StudyContext& context) const override;
  StudyResult replay(std::size_t task, const StudyContext& context) const override;

 private:
  LimitOutcome calibrate_draw(std::size_t task, TruthCache& truths) const;
  double level_of(std::size_t task) const { return options_.noise_levels[place(task, 0)]; }
  Options options_;
};

/// What makes the one or the other.
class CalibrationLimitRecipe final : public Recipe<Experiment> {
 public:
  void visit(OptionVisitor& visitor) override { options_.visit(visitor); }
  std::shared_ptr<const Experiment> make() const override;
  std::unique_ptr<Recipe<Experiment>> clone() const override {
    return std::make_unique<CalibrationLimitRecipe>(*this);
  }

 private:
  CalibrationLimitOptions options_;
};

// What a Monte Carlo study of calibrations says at one noise level.

/// Errors of one parameter at one noise level.
struct LimitRow {
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  double noise_percent = 0.0;
  std::string parameter;
  double rmse = kNan, bias = kNan, bound = kNan, reported = kNan;
  double attainable = kNan;  ///< with the force unknown, of the law alone
  std::size_t count = 0, failures = 0;
  bool law = false;  ///< f_0, B, x_c or the damping factor of the law

  double ratio() const { return rmse / bound; }
};

/// One parameter of the law over all levels with noise, which are independent: errors in bounds.
struct PooledRow {
  std::string parameter;
  double ratio = 0.0;     ///< RMSE/bound
  double bias = 0.0;      ///< in bounds
  double sd_ratio = 0.0;  ///< standard deviation reported over the RMSE
  std::size_t count = 0;
};

/// A run is wrong where an error of the law, of a well-seen f_n or of x_c exceeds 7.8 bounds
/// (another minimum, not noise) or where it broke, contradicted where χ² or a stated prior speaks
/// against its result.
struct LimitSummary {
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  double level = 0.0;
  std::vector<LimitRow> rows;
  double mean_chi2 = kNan, mean_law_chi2 = kNan;
  double chi2_scatter = kNan, chi2_deviation = kNan;  ///< found, and stated by the calibrations
  double free_rms = kNan, free_worst = kNan;  ///< RMSE/bound over the modes with a bound < 5e-4
  double median_error = kNan, paper_error = kNan, median_bound = kNan;
  double force_correlation = kNan;  ///< mean of that of the identified force
  std::size_t runs = 0, broken = 0;
  std::size_t contradicted = 0;         ///< by χ²
  std::size_t priors_contradicted = 0;  ///< priors that the data contradict
  std::size_t wrong = 0;                ///< broken ones included
  std::size_t silent = 0;               ///< wrong and not contradicted

  const LimitRow* find(const std::string& parameter) const;
};

/// Errors beside bounds, a row a parameter and level.
report::Table limit_table(const std::vector<LimitRow>& rows);

LimitSummary summarize_level(const LimitLevel& level, const LimitTruth& truth,
                             const ExpectedLimit& bound);

/// The law's rows of all levels with noise and runs, pooled.
std::vector<PooledRow> pooled_rows(const std::vector<LimitSummary>& levels);

}  // namespace modcal
