// Errors put into the modal model that inverts a record, to study what they cost.
#pragma once

#include "libsim/base/options.hpp"
#include "libsim/base/random.hpp"
#include "libsim/model/modal_basis.hpp"

namespace modcal {

/// Largest relative error of the modal frequencies (uniform, independent in every mode, both
/// signs), relative error of all damping ratios, and error of the contact point [m].
struct ModelErrorOptions {
  double frequencies = 0.0;
  double damping = 0.0;
  double contact = 0.0;
  void visit(OptionVisitor& visitor);
};

/// The model an inversion starts from.
struct AssumedModel {
  ModalBasis basis;
  double contact = 0.0;  ///< x_c [m]
};

/// The true model with the stated errors; those of the frequencies are drawn from `key`.
/// Throws InvalidInput where the contact point leaves the string or a damping ratio leaves [0, 1).
AssumedModel with_errors(const ModalBasis& truth, double contact, const ModelErrorOptions& errors,
                         const StreamKey& key);

}  // namespace modcal
