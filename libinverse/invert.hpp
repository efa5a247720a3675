// The inversion as a user describes it.
#pragma once

#include <memory>

#include "libinverse/estimator.hpp"
#include "libinverse/parameter_choice.hpp"
#include "libinverse/regularizer.hpp"

namespace modcal {

/// Section "inversion" of an experiment: how reactions are turned into a force.
struct InversionOptions {
  Choice<Estimator> estimator{"joint"};
  Choice<Regularizer> regularizer{"water_level"};
  Choice<ParameterChoice> parameter_choice{"minimal_product"};

  void visit(OptionVisitor& visitor);
};

/// The plug-ins of an InversionOptions, made once and shared by all inversions.
class InversionRecipe {
 public:
  /// Throws InvalidInput where an option is out of range.
  explicit InversionRecipe(const InversionOptions& options);
  InversionMethod method(InversionOutputs outputs = {},
                         double noise_rms = std::numeric_limits<double>::quiet_NaN()) const {
    return {*regularizer_, *parameter_choice_, outputs, noise_rms};
  }
  const Estimator& estimator() const { return *estimator_; }

 private:
  std::shared_ptr<const Estimator> estimator_;
  std::shared_ptr<const Regularizer> regularizer_;
  std::shared_ptr<const ParameterChoice> parameter_choice_;
};

}  // namespace modcal
