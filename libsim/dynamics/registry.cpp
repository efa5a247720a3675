
#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"

namespace modcal {

Registry<Simulator> Simulator::registry() {
  static constexpr std::array kTable = {
      entry_of<Simulator, ModalEvent>(
          "modal_event", "exact adherence, collocated sliding, switches located inside the step"),
      entry_of<Simulator, ModalExact>(
          "modal_exact", "exact modal propagator, first-order hold, implicit friction"),
      entry_of<Simulator, NewmarkExplicit>(
          "newmark_explicit",
          "the paper's scheme: average acceleration, force of the previous step"),
  };
  return kTable;
}

}  // namespace modcal
