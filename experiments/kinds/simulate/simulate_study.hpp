// Kind "simulate": a scene, its signals as files and figures.
#pragma once

#include "experiments/experiment.hpp"
#include "experiments/study/figures.hpp"

namespace modcal {

struct SimulateOptions {
  TruthOptions truth;
  Measurement measurement;
  std::vector<std::string> outputs = {"y", "v", "f_c", "R1", "R2"};
  std::vector<std::string> files;
  double wav_full_scale = 1.0;
  std::vector<FigureOptions> figures;
  std::int64_t seed = 1;
  void visit(OptionVisitor& visitor);

  std::vector<Finding> lint() const;
  std::vector<PlanLine> plan() const;
  std::optional<PlannedSimulations> planned_simulations() const;
  StudyResult run(const StudyContext& context) const;
};

}  // namespace modcal
