#include "libinverse/invert.hpp"

namespace modcal {

void InversionOptions::visit(OptionVisitor& visitor) {
  visitor("estimator", "what is estimated from which reactions", estimator);
  visitor("regularizer",
          "what keeps noise from being amplified, where the "
          "estimator leaves it open",
          regularizer);
  visitor("parameter_choice", "how much regularization suits the data", parameter_choice);
}

InversionRecipe::InversionRecipe(const InversionOptions& options)
    : estimator_(options.estimator.make()),
      regularizer_(options.regularizer.make()),
      parameter_choice_(options.parameter_choice.make()) {}

}  // namespace modcal
