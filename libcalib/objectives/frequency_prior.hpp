#pragma once

#include <cstdint>
#include <vector>

#include "libcalib/objective.hpp"

namespace modcal {

/// Gaussian prior from modal frequencies that were measured otherwise, in a pluck test say:
/// r_j = (f_n(x) − f̂_j)/s_j with n = modes_j, value ½ ‖r‖² [1]. The prior acts on the frequencies
/// of the model, whatever moves them: f_n itself or the law (f0, B). Beside joint_likelihood in a
/// weighted_sum, both with weight 1, it gives the posterior: both are in standard deviations of
/// their data. The errors are taken to be independent; the reactions are not looked at.
class FrequencyPrior final : public Objective {
 public:
  struct Options {
    std::vector<std::int64_t> modes;  ///< n ≥ 1, distinct
    std::vector<double> frequencies;  ///< f̂ [Hz], one a mode
    std::vector<double> deviations;   ///< s [Hz], one a mode
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for lists of unequal length, a mode that is named twice or below 1,
  /// frequencies and deviations that are not finite and > 0.
  explicit FrequencyPrior(const Options& options);
  Response response(Moves what) const override;
  bool whitened() const override { return true; }

 private:
  /// Throws InvalidInput for no mode and for one that the model does not have.
  std::unique_ptr<const ObjectiveFunction> do_bind(const CalibrationData& data,
                                                   const ParameterSet& parameters) const override;

  Options options_;
};

}  // namespace modcal
