// Kind "invert": contact force and motion from the reactions of a simulated or recorded string.
#pragma once

#include "experiments/experiment.hpp"
#include "experiments/study/figures.hpp"
#include "libinverse/observer/model_based_estimator.hpp"

namespace modcal {

struct InvertOptions {
  static constexpr std::string_view kForStructures =
      "invert finds the force on a string from the reactions at its ends; on any other structure "
      "state kind: identify_force with table: modes.yaml and record: {file: ..., responses: "
      "[{channel: ...}, ...]}";
  ObservationOptions observation;
  ModelErrorOptions model_error;
  InversionOptions inversion;
  bool has_model_based = false;  ///< the model-based estimate beside the linear ones
  ModelBasedOptions model_based;
  bool wave_based = false;  ///< the wave-based reconstructions beside the linear estimates
  ScoreOptions score;
  std::vector<FigureOptions> figures;
  std::int64_t seed = 1;
  bool write_signals = true;
  bool write_sound = false;
  bool overview = true;
  void visit(OptionVisitor& visitor);
  std::int64_t& seed_slot() { return seed; }
  StreamKey key() const { return StreamKey(static_cast<std::uint64_t>(seed)); }
  std::vector<FileRead> files_read() const;

  /// Whether all signals at the contact are wanted.
  bool wants_all() const { return writes() || overview; }
  /// Whether any file of them is.
  bool writes() const { return write_signals || write_sound; }
  /// identified.csv and identified.wav, as far as they are wanted.
  void add_signals(const SignalFile& signals, StudyResult& result) const;
  /// Without figures and signals where the context reads numbers alone.
  InvertOptions as_read_by(const StudyContext& context) const;

  std::vector<Finding> lint() const;
  std::vector<Finding> lint_records(const std::filesystem::path& folder) const;
  std::vector<PlanLine> plan() const;
  std::optional<PlannedSimulations> planned_simulations() const;
  StudyResult run(const StudyContext& context) const;
};

/// The file of a record. Of one that is cropped the work is not foreseen: its rate is in the file.
FileRead file_read(const RecordOptions& record, std::string key, double numbers_per_sample);

/// Findings about an inversion, without its figures.
std::vector<Finding> lint_inversion(const InvertOptions& options);
/// Windows of scores and figures that hold nothing of the record.
void lint_windows(const InvertOptions& options, const Observation& observation,
                  std::vector<Finding>& findings);

/// Signals of the truth that the figures and scores need; `all` for an overview.
OutputRequest truth_outputs(const std::vector<FigureOptions>& figures, bool all = false);
/// What an inversion has to compute for them; `all` signals and what an overview shows.
InversionOutputs inversion_outputs(const std::vector<FigureOptions>& figures, bool all);
/// One row a side and window: parameter, share of bins kept, correlation, relative rms error.
report::Table identification_table(const std::vector<SideIdentification>& sides);
/// It, and what was measured of the motion beside, where it was.
void add_identification_tables(const std::vector<SideIdentification>& sides, StudyResult& result);
/// Draws the waveforms, spectra and parameter curves among the figures asked for.
void add_identification_figures(const std::vector<FigureOptions>& figures,
                                const Observation& observation,
                                const std::vector<SideIdentification>& sides, StudyResult& result);
/// A side in a table: 1 and 2 are numbers, as the paper counts them.
report::Cell side_cell(const std::string& side);
/// Every identified signal, in a file without an extension.
SignalFile identified_signals(const Observation& observation,
                              const std::vector<SideIdentification>& sides);
/// One line a side and window of the scores, and the scores for programs.
void add_scores(const std::vector<SideIdentification>& sides, StudyResult& result);
/// Warnings of the observation and of the estimates, and what to try against them.
/// is_calibrated: the model has been found from this record already.
void add_warnings(const Observation& observation, const std::vector<SideIdentification>& sides,
                  bool is_calibrated, StudyResult& result);
/// What the observation and the estimates took for granted.
void add_notes(const Observation& observation, const std::vector<SideIdentification>& sides,
               StudyResult& result);

// Estimates beside the linear ones, by a friction law and by waves: scored where the truth is
// known, drawn, and added to the result of an inversion.

/// One window of comparison, anti-aliased figures included where the score asks for them.
struct ModelScore {
  std::string window;  ///< "0.78 s", or "0.1 s to 0.95 s" of the long window
  WindowScore model;   ///< the model-based estimate
  WindowScore linear;  ///< the linear estimate the observer started from
};

struct ModelIdentification {
  ModelBasedResult result;
  std::vector<ModelScore> scores;  ///< the windows asked for, then the long one
};

/// Estimates and scores. Throws InvalidInput for an observation with one reaction.
ModelIdentification identify_by_model(const Observation& observation, const AssumedModel& model,
                                      const ModelBasedOptions& options, const ScoreOptions& score,
                                      const StopToken& stop);

/// Force over slip speed: loops over two periods, cells with their 5–95 % spread of the model-based
/// and the linear estimate, the fitted law.
report::Figure friction_figure(const Observation& observation, const ModelBasedResult& result,
                               double start, double duration);
/// Identified force over the true and the linear one, `duration` from `start` on [s].
report::Figure model_force_figure(const Observation& observation, const ModelBasedResult& result,
                                  double start, double duration);

/// Tables, figures, warnings and lines of the summary.
void add_model_based(const Observation& observation, const ModelIdentification& identification,
                     const ScoreOptions& score, StudyResult& result);
/// Adds f_c_model, v_model and y_model to identified signals.
void add_model_signals(const Observation& observation, const ModelBasedResult& model,
                       SignalFile& file);

/// Reconstructs the force from the waves of both reactions, in the time domain (ideal string) and
/// with loss and dispersion, from either outgoing wave, and scores it where a reference is known: a
/// baseline, and a check that shares no code with the modal inversion. Throws InvalidInput for an
/// observation with one reaction.
void add_wave_based(const Observation& observation, const AssumedModel& model,
                    const ScoreOptions& score, StudyResult& result);

}  // namespace modcal
