#include "experiments/study/model_error.hpp"

#include <vector>

#include "libsim/base/error.hpp"

namespace modcal {

void ModelErrorOptions::visit(OptionVisitor& visitor) {
  visitor.number({.key = "frequencies",
                  .meaning = "largest relative error of the modal frequencies, drawn for each mode",
                  .unit = "1",
                  .range = {0.0, 1.0, true, false}},
                 frequencies);
  visitor.number({.key = "damping",
                  .meaning = "relative error of all damping ratios",
                  .unit = "1",
                  .range = Range::at_least(-1.0)},
                 damping);
  visitor.number({.key = "contact", .meaning = "error of the contact point", .unit = "m"}, contact);
}

AssumedModel with_errors(const ModalBasis& truth, double contact, const ModelErrorOptions& errors,
                         const StreamKey& key) {
  AssumedModel model{truth, contact + errors.contact};
  MODCAL_REQUIRE(model.contact > 0.0 && model.contact < truth.length,
                 "the assumed contact point {:g} m (true {:g} m, error {:g} m) is not inside the "
                 "string of {:g} m",
                 model.contact, contact, errors.contact, truth.length);
  std::vector<double> uniform(truth.size());
  fill_uniform(key, uniform);
  for (std::size_t n = 0; n < truth.size(); ++n) {
    model.basis.omega[n] *= 1.0 + errors.frequencies * (2.0 * uniform[n] - 1.0);
    model.basis.zeta[n] *= 1.0 + errors.damping;
    MODCAL_REQUIRE(model.basis.zeta[n] < 1.0,
                   "damping ratio {:g} of mode {} (error {:g} %) must stay below 1",
                   model.basis.zeta[n], n + 1, 100.0 * errors.damping);
  }
  return model;
}

}  // namespace modcal
