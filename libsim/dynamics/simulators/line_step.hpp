// Fixed-step simulation of what one point under a steady bow does not cover: gestures, friction
// with a state, bows of finite width.
#pragma once

#include "libsim/dynamics/line_loop.hpp"
#include "libsim/dynamics/simulators/fixed_step.hpp"

namespace modcal {

/// As simulate_fixed_step(), by the general loop whatever the scene needs.
Simulation simulate_line(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                         const StopToken& stop, double wanted_time_step, ForceTiming timing,
                         WeightsOfPole weights_of_pole);

}  // namespace modcal
