// One cell of the stability map: a scene, a simulator, a time step, and whether the outcome is
// right.
#pragma once

#include <string>
#include <string_view>

#include "libsim/dynamics/scene.hpp"

namespace modcal {

enum class Outcome {
  kRight,     ///< finite, within the friction limit, passive, and the energy balance closes
  kRefused,   ///< InvalidInput before the first step
  kReported,  ///< Simulation::diverged_at with an explanation
  kWrong,     ///< anything else
};

struct CellResult {
  Outcome outcome = Outcome::kWrong;
  std::string reason;       ///< of a refusal, a report or a wrong outcome
  double unbalanced = 0.0;  ///< |residual| over all energy at hand [1]
  double allowed = 0.0;     ///< its bound [1]
  double passivity = 0.0;   ///< loss at the contact over ∫|f v_c| dt, −1 … 1
};

/// Simulates `samples` steps of `time_step` [s] and checks what comes out.
CellResult run_cell(std::string_view simulator, Scene scene, double time_step, std::size_t samples);

/// Samples that keep simulation and audit of such a cell at about a tenth of a second; ≥ 20.
std::size_t affordable_samples(const Scene& scene, double time_step);

}  // namespace modcal
