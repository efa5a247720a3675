// Kind "identify": free decays of a plucked string, simulated or recorded, or of any structure: the
// modes with error bars.
#pragma once

#include "experiments/experiment.hpp"
#include "experiments/kinds/identify/identify_record.hpp"
#include "experiments/kinds/structure/structure_files.hpp"
#include "libcalib/parameters/stiff_string_fit.hpp"

namespace modcal {

/// A structure that rings freely.
struct DecayingStructure {
  StructureRecordOptions record;
  void visit(OptionVisitor& visitor);
};

struct IdentifyOptions {
  static constexpr std::string_view kForStructures =
      "identify finds modes from free decays: state structure: {record: {file: ..., responses: "
      "[{channel: ...}, ...]}}; for a table with the force's constants state kind: fit_modes with "
      "a record of responses and force";
  bool has_scene = false;
  TruthOptions truth;
  Measurement measurement;
  bool has_record = false;
  RecordOptions record;
  double fundamental = std::numeric_limits<double>::quiet_NaN();  ///< of a record [Hz]
  bool has_structure = false;
  DecayingStructure structure;
  PluckOptions identification;
  std::int64_t seed = 1;
  void visit(OptionVisitor& visitor);

  std::vector<Finding> lint() const;
  std::vector<Finding> lint_records(const std::filesystem::path& folder) const;
  std::vector<PlanLine> plan() const;
  std::optional<PlannedSimulations> planned_simulations() const;
  std::vector<FileRead> files_read() const;
  StudyResult run(const StudyContext& context) const;

 private:
  std::vector<Finding> lint_simulated() const;
  std::vector<Finding> lint_recorded() const;
};

struct IdentifyOutcome {
  PluckIdentification found;
  std::shared_ptr<const Truth> truth;  ///< null: recorded
  std::optional<PluckedRecord> record;
  /// Law through the frequencies, weighted by their deviations where they have some; empty with
  /// fewer than two modes.
  std::optional<StiffStringFit> law;
  /// Modes, law and noise.
  void visit(ResultVisitor& visitor) const;

 private:
  void visit_shapes(ResultVisitor& visitor) const;
};

/// f₀ and B through the frequencies; empty with fewer than two modes.
std::optional<StiffStringFit> law_of(const PluckIdentification& found);

/// How many modes, the law, the mains.
std::string sentence_of(const IdentifyOutcome& outcome, double highest_frequency);

/// Frequencies against the truth, or of a record against the law through all of them.
report::Figure errors_figure(const IdentifyOutcome& outcome);

/// Simulates and measures, or reads, and identifies.
IdentifyOutcome identify_outcome(const IdentifyOptions& options, const StudyContext& context);

/// Poles over the order of the realization, stable ones apart.
report::Figure stabilization_figure(const IdentifyOutcome& outcome);

}  // namespace modcal
