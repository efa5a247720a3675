#pragma once

#include "libsim/dynamics/event/event_loop.hpp"
#include "libsim/dynamics/scene/simulator.hpp"

namespace modcal {

/// Event-driven integrator. The held string (adherence is linear) is advanced exactly in the
/// coordinates of the closed loop; the sliding string by collocation of the force at Lobatto nodes
/// on the exact modal propagator (order 2(nodes − 1) in the force's smooth stretches); the switches
/// between them are located to rounding inside the step, and a bound on what the interpolants leave
/// out certifies that none is missed.
///
/// Hysteresis: adherence ends only at |f_c| = μ_S F_N, sliding only at v_c = 0. At attachment the
/// literal rule starts the spring unstretched, f_c = 0 (Debut, Delaune and Antunes, 2010, eq. 8),
/// the continuous one stretched by −f_c/K_a. A string released while it moves against the slip
/// slides in the direction of its motion.
///
/// A gesture's knots end steps: between them velocity and normal force are linear, adherence
/// follows in closed form and the static limit is a line. At F_N = 0 the string decays freely.
///
/// The temperature of thermal friction is collocated with the force at the same nodes while the
/// string slides, and cools in closed form while it sticks; the limit that ends adherence is then
/// the one of the temperature at that instant.
///
/// A run that cannot go on (contact chatter, a friction equation without solution) ends with
/// `diverged_at` and the reason in `explanation`. Throws InvalidInput where adherence has a double
/// root or turns by more than 1e4 rad in a step.
class ModalEvent final : public Simulator {
 public:
  struct Options {
    std::int64_t nodes = 5;  ///< Lobatto nodes of a sliding step
    /// Longest step [s]; the largest smaller one that divides 1/f_s is taken. NaN: 1/f_s.
    double max_step = std::numeric_limits<double>::quiet_NaN();
    /// κ: sliding steps h are halved until |dg/du| h/m_eff ≤ κ. Above 0.35 the steps after a
    /// release limit the accuracy of steep laws.
    double slope_number = 0.35;
    std::string attach = "literal";
    /// r: sliding steps are halved until the highest power of the collocated force in the part θ of
    /// the step, times h/m_eff, is below r^{s−1} (|v_bow| + |v_c|): what the polynomial leaves out.
    double tail_ratio = 0.3;
    void visit(OptionVisitor& visitor);
  };
  explicit ModalEvent(const Options& options);

  /// simulate(), bit by bit, under the eyes of an observer.
  Simulation simulate_watched(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                              const event::Watch& watch, const StopToken& stop = {}) const;

 private:
  std::vector<SceneRefusal> unsupported(const Scene& scene) const override;
  Simulation run(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                 const StopToken& stop) const override;
  Options options_;
  const event::Watch* watch_ = nullptr;
};

}  // namespace modcal
