#include "libinverse/inversion_options.hpp"

#include "libsim/base/error.hpp"

namespace modcal {

void InversionOptions::visit(OptionVisitor& visitor) {
  visitor.text({.key = "estimator",
                .meaning = "one_sided: each reaction gives a force of its own",
                .choices = {"one_sided"}},
               estimator);
  visitor.plugin({.key = "regularizer", .meaning = "what keeps noise from being amplified"},
                 regularizer);
  visitor.plugin({.key = "parameter_choice", .meaning = "how much regularization suits the data"},
                 parameter_choice);
}

InversionRecipe::InversionRecipe(const InversionOptions& options)
    : regularizer_(options.regularizer.make()), parameter_choice_(options.parameter_choice.make()) {
  MODCAL_REQUIRE(options.estimator == "one_sided",
                 "unknown estimator \"{}\": one_sided is available", options.estimator);
}

}  // namespace modcal
