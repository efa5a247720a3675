// Kind "pluck_then_bow": the route of section 7 of Debut, Delaune and Antunes (2010) on synthetic
// data, and the calibration to the bound beside it.
#pragma once

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/kinds/identify/identify.hpp"
#include "libsim/model/damping.hpp"

namespace modcal {

/// The pluck test before the stroke: the string of the scene without its bow.
struct PluckTestOptions {
  Choice<InitialMotion> start{"pluck"};
  double duration = 1.0;
  double noise_level = 0.01;
  PluckOptions identification;
  std::int64_t damping_degree = 2;  ///< of the polynomial that extrapolates the damping
  void visit(OptionVisitor& visitor);
};

/// How the frequencies are refined on the bowed record.
struct RefinementOptions {
  std::int64_t first_modes = 5;  ///< plucked modes that are refined before the law is fitted
  std::int64_t law_modes = 11;   ///< modes that the first law is fitted to
  Choice<Objective> objective{"spectral_peak"};
  Choice<Optimizer> optimizer{"mode_by_mode"};
  Budget budget;
  double excitation_threshold = 0.1;  ///< modes with a smaller |φ_n(x_c)| come from the law [1]
  void visit(OptionVisitor& visitor);
};

/// How the contact point is adjusted.
struct ContactSearchOptions {
  double start = std::numeric_limits<double>::quiet_NaN();  ///< [m]
  double range = 3e-3;                                      ///< to either side [m]
  std::int64_t points = 61;                                 ///< of the curve that brackets it
  Choice<Objective> objective{"contact_location"};
  void visit(OptionVisitor& visitor);
};

struct PluckThenBowOptions {
  static constexpr std::string_view kForStructures =
      "pluck_then_bow plucks and bows a string; for any other structure state kind: fit_modes with "
      "a "
      "strike whose force was measured, then kind: identify_force with its table";
  TruthOptions truth;
  Measurement measurement;
  PluckTestOptions pluck;
  RefinementOptions refinement;
  ContactSearchOptions contact;
  bool has_bound = false;  ///< the calibration to the bound from the same pluck test
  CalibrationOptions bound = calibration_to_the_bound();
  InversionOptions inversion;
  ScoreOptions score;
  std::vector<FigureOptions> figures;
  std::int64_t seed = 1;
  void visit(OptionVisitor& visitor);

  std::vector<Finding> lint() const;
  std::vector<PlanLine> plan() const;
  std::optional<PlannedSimulations> planned_simulations() const;
  StudyResult run(const StudyContext& context) const;

  StreamKey key() const { return StreamKey(static_cast<std::uint64_t>(seed)); }
  /// The pluck test as an experiment of its own.
  IdentifyOptions pluck_test(std::string_view method) const;
  /// The stroke as an observation.
  ObservationOptions stroke() const;
};

/// The model after a step of the route.
struct ModelStage {
  std::string key;    ///< for files: "refined"
  std::string title;  ///< for tables and figures
  AssumedModel model;
  StiffStringFit law;  ///< deviations NaN where the step gives none
  double contact_deviation = std::numeric_limits<double>::quiet_NaN();  ///< [m]
  std::vector<double> deviation;  ///< relative, by mode; empty: not known
  std::int64_t evaluations = 0;
  /// |f_n/f_n(truth) − 1| over the modes the contact excites; NaN of the truth itself.
  double median_error = std::numeric_limits<double>::quiet_NaN();
  double largest_error = std::numeric_limits<double>::quiet_NaN();
  void visit(ResultVisitor& visitor) const;
};

/// Objective against the contact point.
struct ContactCurve {
  std::vector<double> positions;  ///< [m]
  std::vector<double> values;
};

struct PluckThenBowOutcome {
  IdentifyOutcome pluck;       ///< poles by the method of the options
  IdentifyOutcome likelihood;  ///< by maximum likelihood, with error bars
  DampingFit damping;
  Observation stroke;
  CalibrationOutcome first;  ///< search of the first modes
  CalibrationOutcome all;    ///< search of all modes
  ContactCurve curve;
  std::vector<ModelStage> stages;  ///< in the order of the route
  std::vector<SideIdentification> sides;
  bool has_bound = false;
  ContinuationResult bound;
  std::vector<ModelStage> bound_stages;  ///< from the law of the pluck test to the posterior
  std::vector<SideIdentification> bound_sides;
  ModelStage truth;
  void visit(ResultVisitor& visitor) const;
};

/// Throws InvalidInput where the pluck test gives too few modes to go on.
PluckThenBowOutcome pluck_then_bow(const PluckThenBowOptions& options, const StudyContext& context);

/// Starts of the calibration to the bound, the calibration and its posterior under the pluck test.
void add_bound_stages(const PluckThenBowOptions& options, const StudyContext& context,
                      PluckThenBowOutcome& outcome);
/// A basis of `modes` modes that follow the law, damped by the polynomial.
ModalBasis law_basis(const PluckThenBowOptions& options, const StiffStringFit& law,
                     const DampingFit& damping, std::size_t modes);
DampingFit damping_of(const PluckIdentification& found, std::int64_t degree);

std::vector<report::Figure> pluck_then_bow_figures(const PluckThenBowOptions& options,
                                                   const PluckThenBowOutcome& outcome);

}  // namespace modcal
