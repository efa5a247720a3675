// Kind "calibration_limit" of any structure: how far off its modes are when K responses refine them
// without the force, beside the Cramér–Rao bound.
#pragma once

#include <mutex>

#include "experiments/kinds/limit/limit.hpp"
#include "libinverse/structure/blind_fit.hpp"

namespace modcal {

/// One refinement of one noise draw. Errors are relative: ln f, ln ζ, and d of A (1 + d), real and
/// imaginary part, as in BlindFit.
struct StructureLimitOutcome {
  std::string failure;
  std::vector<double> errors, deviations;
  void visit(ResultVisitor& visitor);
};

/// All draws of one noise level.
struct StructureLimitLevel {
  double noise_level = 0.0;
  std::vector<double> bound;  ///< of every unknown
  std::vector<StructureLimitOutcome> outcomes;
};

/// Adds tables, figure and acceptance to a result that knows how many failed. Frequencies [Hz] and
/// names of sensors say which unknown is which.
void sum_up_structure_limit(const std::vector<double>& frequencies,
                            const std::vector<std::string>& sensors,
                            const std::vector<StructureLimitLevel>& levels, StudyResult& result);

/// A bow on the structure of a table, simulated once. Each draw starts from a table that is off by
/// normal numbers of the change's deviations, adds noise and refines it as kind "calibrate" does by
/// its default contour.
class StructureLimitExperiment final : public ProductExperiment {
 public:
  explicit StructureLimitExperiment(CalibrationLimitOptions options);
  std::string_view for_structures() const override {
    return CalibrationLimitOptions::kForStructures;
  }
  std::vector<Finding> lint() const override;
  std::vector<Finding> lint_records(const std::filesystem::path& folder) const override;
  std::vector<PlanLine> plan() const override;
  std::vector<FileRead> files_read() const override;
  std::shared_ptr<const LimitQuestion> limit_question() const override;

  std::string fingerprint(std::size_t task, const std::filesystem::path& folder) const override;
  std::string run_task(std::size_t task, const StudyContext& context) const override;
  StudyResult sum_up(const TaskOutcomes& outcomes, const StudyContext& context) const override;
  StudyResult replay(std::size_t task, const StudyContext& context) const override;

 private:
  struct Truth;
  const Truth& truth(const StudyContext& context) const;
  Truth simulated(const StudyContext& context) const;
  StructureLimitOutcome draw(std::size_t task, const StudyContext& context) const;
  StudyResult sum_up_levels(std::vector<StructureLimitLevel> levels, const StudyContext& context,
                            StudyResult result) const;
  double level_of(std::size_t task) const { return options_.noise_levels[place(task, 0)]; }

  CalibrationLimitOptions options_;
  mutable std::once_flag simulated_;
  mutable std::shared_ptr<const Truth> truth_;
  mutable std::string failure_;  ///< why there is none
};

}  // namespace modcal
