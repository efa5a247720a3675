#include "libinverse/invert.hpp"

namespace modcal {

void InversionOptions::visit(OptionVisitor& visitor) {
  visitor.plugin({.key = "estimator", .meaning = "what is estimated from which reactions"},
                 estimator);
  visitor.plugin({.key = "regularizer",
                  .meaning = "what keeps noise from being amplified, where the "
                             "estimator leaves it open"},
                 regularizer);
  visitor.plugin({.key = "parameter_choice", .meaning = "how much regularization suits the data"},
                 parameter_choice);
}

InversionRecipe::InversionRecipe(const InversionOptions& options)
    : estimator_(options.estimator.make()),
      regularizer_(options.regularizer.make()),
      parameter_choice_(options.parameter_choice.make()) {}

}  // namespace modcal
