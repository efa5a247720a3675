// One cell of the stability map: a scene, a simulator, a time step, and whether the outcome is
// right.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "libsim/dynamics/scene/scene.hpp"

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
  double allowed = 0.0;     ///< its bound [1], below kTightBound
  double passivity = 0.0;   ///< loss at the contact over ∫|f v_c| dt, −1 … 1
  /// modal_event: relative L2 distance of y from a run with a quarter of the step. NaN: not known.
  double distance = std::numeric_limits<double>::quiet_NaN();
  /// Where that is above kSameMotion: how far the run with a quarter of the step moves with the
  /// initial velocity of every mode 1e-12 m/s higher. NaN: not asked for.
  double sensitivity = std::numeric_limits<double>::quiet_NaN();
};

/// A balance whose bound is wider says too little.
constexpr double kTightBound = 1e-4;
/// Runs closer than this are one motion.
constexpr double kSameMotion = 1e-3;
/// A motion that 1e-12 m/s change by more than this has no digits that a step could miss.
constexpr double kNoDigits = 1e-4;

/// Simulates `samples` steps of `time_step` [s] and checks what comes out.
CellResult run_cell(std::string_view simulator, Scene scene, double time_step, std::size_t samples);

/// Scenes of the paper's case with a bow that does what the parameters above do not: its gestures
/// and the start span a record of `duration` [s].
struct NamedScene {
  std::string name;
  Scene scene;
};
std::vector<NamedScene> moving_bows(double duration);
/// The paper's case with every other friction law, torsion and wide bows.
std::vector<NamedScene> other_contacts(double duration);

/// Samples that keep simulation and audit of such a cell at about a second at most; ≥ 4.
std::size_t affordable_samples(const Scene& scene, double time_step);

}  // namespace modcal
