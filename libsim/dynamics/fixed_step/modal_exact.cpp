#include "libsim/dynamics/fixed_step/modal_exact.hpp"

#include "libsim/dynamics/fixed_step/first_order_hold.hpp"

namespace modcal {

Simulation ModalExact::run(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                           const StopToken& stop) const {
  return simulate_fixed_step(scene, sample_rate, outputs, stop, options_.time_step,
                             ForceTiming::kImplicit, first_order_hold_weights);
}

}  // namespace modcal
