// One bow stroke on a stiff string, as the calibration studies of this folder measure it.
#pragma once

#include <cstdint>
#include <vector>

#include "libcalib/problem/calibration_data.hpp"
#include "libcalib/parameters/parameters.hpp"
#include "libsim/base/random.hpp"
#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

inline constexpr double kStrokeRate = 51200.0;

struct StiffStroke {
  ModelPoint truth;
  Simulation run;
  std::vector<double> left, right;  ///< with noise, means removed [N]
  double left_noise = 0.0;          ///< standard deviation [N]
  double right_noise = 0.0;
  CalibrationData data;
};

/// The paper's string and bow, B = 1.4e-4, x_c = 28.5 mm; noise of `level` times the standard
/// deviation of each reaction.
inline StiffStroke stiff_stroke(std::int64_t modes, double duration, double level,
                                std::uint64_t seed) {
  Scene scene;
  scene.string.length = 0.33;
  scene.string.linear_density = 3.1e-3;
  scene.string.fundamental = 196.0;
  scene.string.inharmonicity = 1.4e-4;
  scene.string.modes = modes;
  scene.bow.position = 0.0285;
  scene.duration = duration;
  StiffStroke stroke{.truth = {make_modal_basis(scene.string), scene.bow.position}};
  stroke.run = ModalEvent({}).simulate(
      scene, kStrokeRate, {.force = true, .left_reaction = true, .right_reaction = true});
  const auto measured = [&](const Signal& reaction, std::string_view end, double& deviation) {
    std::vector<double> samples = reaction.samples;
    deviation = level * standard_deviation(samples);
    std::vector<double> noise(samples.size());
    fill_standard_normal(StreamKey(seed).with("measurement noise").with(end), noise);
    for (std::size_t j = 0; j < noise.size(); ++j) samples[j] += deviation * noise[j];
    remove_mean(samples);
    return samples;
  };
  stroke.left = measured(stroke.run.left_reaction, "left", stroke.left_noise);
  stroke.right = measured(stroke.run.right_reaction, "right", stroke.right_noise);
  stroke.data = CalibrationData::of_records(stroke.left, stroke.right, kStrokeRate);
  return stroke;
}

}  // namespace modcal
