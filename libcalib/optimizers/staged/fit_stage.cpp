#include "libcalib/optimizers/staged/fit_stage.hpp"

namespace modcal {

void append_stages(const std::vector<FitStage>& further, const std::string& prefix,
                   std::size_t evaluations, std::vector<FitStage>& stages) {
  for (FitStage stage : further) {
    stage.name = prefix + stage.name;
    stage.evaluations += evaluations;
    stages.push_back(std::move(stage));
  }
}

}  // namespace modcal
