// Kind "simulate": a scene, of a string or of any structure, its signals as files and figures.
#pragma once

#include "experiments/experiment.hpp"
#include "experiments/kinds/simulate/structure_scene.hpp"
#include "experiments/study/figures.hpp"

namespace modcal {

struct SimulateOptions {
  static constexpr std::string_view kForStructures =
      "state structure: {table: modes.yaml, bow: ..., friction: ...} in the place of scene:";
  bool has_scene = false;
  TruthOptions truth;  ///< its scene is unread where a structure is stated
  bool has_structure = false;
  StructureSceneOptions structure;
  Measurement measurement;
  std::vector<std::string> outputs = {"y", "v", "f_c", "R1", "R2"};
  std::vector<std::string> files;
  double wav_full_scale = 1.0;
  std::vector<FigureOptions> figures;
  std::int64_t seed = 1;
  void visit(OptionVisitor& visitor);

  std::vector<Finding> lint() const;
  std::vector<Finding> lint_records(const std::filesystem::path& folder) const;
  std::vector<PlanLine> plan() const;
  std::optional<PlannedSimulations> planned_simulations() const;
  std::vector<FileRead> files_read() const;
  StudyResult run(const StudyContext& context) const;

 private:
  std::vector<Finding> lint_signals() const;
  StudyResult run_structure(const StudyContext& context) const;
};

/// Tables of the signals and of the run, the files that the options ask for, and the sentence that
/// ends the summary; its first line is the answer.
void add_signals(const std::vector<Signal>& signals, const Simulation& simulation,
                 const SimulateOptions& options, StudyResult& result);

}  // namespace modcal
