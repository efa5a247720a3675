// Kind "simulate": a scene, its signals as files and figures.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiments/study/figure_options.hpp"
#include "experiments/study/study.hpp"
#include "libsim/signal/measurement.hpp"

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
};

/// The outputs by their names: y, v, f_c, R1, R2.
OutputRequest request_of(const std::vector<std::string>& outputs);

StudyResult simulate_study(const SimulateOptions& options, const StudyContext& context);

}  // namespace modcal
