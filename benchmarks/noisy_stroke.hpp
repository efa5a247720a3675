// One second of the paper's string or a stiff one with noise, and a start with errors of ±2 % in
// every frequency and 1.5 mm in x_c.
#pragma once

#include <string_view>
#include <vector>

#include "libcalib/optimizers/staged/continuation.hpp"
#include "libsim/base/random.hpp"
#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

inline constexpr double kRate = 51200.0;
inline constexpr double kNoise = 0.01;

struct NoisyStroke {
  ModelPoint truth, start;
  std::vector<double> left, right;
  CalibrationData data;
  ContinuationOptions options;
};

inline std::vector<double> with_noise(std::vector<double> samples, double deviation,
                                      std::string_view end, std::uint64_t seed) {
  std::vector<double> noise(samples.size());
  fill_standard_normal(StreamKey(seed).with("measurement noise").with(end), noise);
  for (std::size_t j = 0; j < noise.size(); ++j) samples[j] += deviation * noise[j];
  remove_mean(samples);
  return samples;
}

struct StrokeCase {
  double noise = kNoise;  ///< of each signal's standard deviation
  double inharmonicity = 0.0;
  std::uint64_t seed = 1;
};

inline NoisyStroke make_noisy_stroke(const StrokeCase& the = {}) {
  Scene scene;
  scene.string.length = 0.33;
  scene.string.linear_density = 3.1e-3;
  scene.string.fundamental = 196.0;
  scene.string.inharmonicity = the.inharmonicity;
  scene.bow.position = 0.03;
  const Simulation run =
      ModalEvent({}).simulate(scene, kRate, {.left_reaction = true, .right_reaction = true});
  NoisyStroke result{.truth = {make_modal_basis(scene.string), scene.bow.position}};
  result.options.left_noise = the.noise * standard_deviation(run.left_reaction.samples);
  result.options.right_noise = the.noise * standard_deviation(run.right_reaction.samples);
  result.left = with_noise(run.left_reaction.samples, result.options.left_noise, "left", the.seed);
  result.right =
      with_noise(run.right_reaction.samples, result.options.right_noise, "right", the.seed);
  result.data = CalibrationData::of_records(result.left, result.right, kRate);
  result.start = result.truth;
  std::vector<double> draw(result.truth.basis.size());
  fill_uniform(StreamKey(the.seed).with("start"), draw);
  for (std::size_t n = 0; n < draw.size(); ++n) {
    result.start.basis.omega[n] *= 1.0 + 0.02 * (2.0 * draw[n] - 1.0);
  }
  result.start.contact += 1.5e-3;
  return result;
}

}  // namespace modcal
