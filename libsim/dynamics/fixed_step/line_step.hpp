// Fixed-step simulation of what one point under a steady bow does not cover: gestures, friction
// with a state, bows of finite width.
#pragma once

#include "libsim/dynamics/fixed_step/line_loop.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"

namespace modcal {

/// Samples of one contact point.
struct PointMotion {
  explicit PointMotion(std::size_t count) : displacement(count), velocity(count), force(count) {}
  std::vector<double> displacement;  ///< y_j [m]
  std::vector<double> velocity;      ///< v_j [m/s]
  std::vector<double> force;         ///< f_j [N]
};

/// As simulate_fixed_step(), by the general loop whatever the scene needs. `points`, where asked
/// for, takes the motion of every contact point.
Simulation simulate_line(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                         const StopToken& stop, double wanted_time_step, ForceTiming timing,
                         WeightsOfPole weights_of_pole, std::vector<PointMotion>* points = nullptr);

}  // namespace modcal
