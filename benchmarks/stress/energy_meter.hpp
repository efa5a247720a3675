// Integrates the energies of an event-driven run from the pieces of its contact force.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "benchmarks/stress/energy_account.hpp"
#include "libsim/dynamics/event/modal_event.hpp"

namespace modcal::event {

/// Replays the string under the force alone, in arithmetic of its own (ModeReplay), and takes
/// the velocity that comes out of it for everything: works are integrals of polynomials in time,
/// the law's own force is computed anew at 14 Gauss points of every piece, elongation is the
/// integral of v_c from the attachment on.
class EnergyMeter final : public ForceObserver {
 public:
  /// The contact of `loop` and the state that the run starts from.
  EnergyMeter(const EventLoop& loop, const ContactModes& modes, const EventState& start);

  void piece(const ForcePiece& piece) override;
  void attached(double elongation) override;
  void released() override;
  /// The account up to the integrator's final state.
  EventEnergy account(const EventState& end) const;

 private:
  void part(const ForcePiece& piece);
  void divide(const ForcePiece& piece, double phase);
  double law_force(const ForcePiece& piece, double theta, double slip, double elongation) const;
  double spring_energy() const { return 0.5 * stiffness_ * elongation_ * elongation_; }

  double stiffness_, damping_;
  SlidingLaw law_;
  std::optional<ThermalSliding> thermal_;
  ModeReplay replay_;
  GaussRule rule_;
  PointPowers velocities_;  // powers of θ of v on the running piece
  bool sticking_ = false;
  double elongation_ = 0.0;
  double start_energy_ = 0.0, start_spring_ = 0.0;
  EventEnergy sum_;
};

}  // namespace modcal::event

namespace modcal {

struct AuditedRun {
  Simulation simulation;  ///< the same as simulate()'s, bit by bit
  EventEnergy energy;     ///< zero where the run stopped early
};
/// Simulates and integrates the energies of the run over its own steps. Takes 10 to 100 times as
/// long.
AuditedRun simulate_audited(const ModalEvent& simulator, const Scene& scene, double sample_rate,
                            const OutputRequest& outputs);

}  // namespace modcal
