// Identified motion at the contact from each reaction, scored where a reference is known.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "experiments/study/model_error.hpp"
#include "experiments/study/observation.hpp"
#include "experiments/study/scoring.hpp"
#include "libinverse/inversion_options.hpp"

namespace modcal {

struct SideIdentification {
  End end = End::kLeft;
  InversionResult result;
  double largest_transfer = 0.0;    ///< max |H_r| [N/N]
  std::vector<WindowScore> scores;  ///< of the force; empty without a reference
};

/// Inversions of both sides prepared for one model and record length, shared by many noise draws.
class PreparedInversions {
 public:
  PreparedInversions(const AssumedModel& model, std::size_t samples, double sample_rate);
  const OneSidedInversion& of(End end) const { return *sides_[static_cast<std::size_t>(end)]; }

 private:
  std::unique_ptr<const OneSidedInversion> sides_[2];
};

/// Prepared inversions shared by all cells of a sweep that assume the same model.
class InversionCache {
 public:
  std::shared_ptr<const PreparedInversions> get(const AssumedModel& model, std::size_t samples,
                                                double sample_rate);

 private:
  std::mutex mutex_;
  // The model's numbers, bit for bit.
  std::map<std::vector<double>, std::shared_ptr<const PreparedInversions>> prepared_;
};

/// Inverts every reaction of the observation; `score` null: no scores.
std::vector<SideIdentification> identify(const Observation& observation,
                                         const PreparedInversions& inversions,
                                         const InversionRecipe& recipe,
                                         const InversionOutputs& outputs,
                                         const ScoreOptions* score);

}  // namespace modcal
