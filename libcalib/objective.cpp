#include "libcalib/objective.hpp"

#include "libsim/base/error.hpp"

namespace modcal {

std::unique_ptr<const ObjectiveFunction> Objective::bind(const CalibrationData& data,
                                                         const ParameterSet& parameters) const {
  data.require_valid();
  const ModalBasis& basis = parameters.initial().basis;
  for (std::size_t n = 0; n < basis.size(); ++n) {
    MODCAL_REQUIRE(basis.zeta[n] > 0.0,
                   "mode {} has damping ratio {:g}: without damping its response has no bound on "
                   "the frequency axis; give it a ratio > 0",
                   n + 1, basis.zeta[n]);
    MODCAL_REQUIRE(basis.frequency(n) < 0.5 * data.sample_rate,
                   "mode {} at {:g} Hz lies above the Nyquist frequency {:g} Hz of the data: take "
                   "fewer modes",
                   n + 1, basis.frequency(n), 0.5 * data.sample_rate);
  }
  return do_bind(data, parameters);
}

}  // namespace modcal
