// Data for calibrations: the paper's string, its frequencies off by a few percent.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "libcalib/parameters/parameters.hpp"
#include "libcalib/problem/calibration_data.hpp"
#include "libsim/base/random.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "libsim/dynamics/scene/simulator.hpp"
#include "libsim/model/modal_basis.hpp"
#include "libsim/signal/measurement.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {

inline ModelPoint paper_truth(std::int64_t modes, double inharmonicity = 0.0,
                              double contact = 0.03) {
  StringModel string = paper_scene().string;
  string.modes = modes;
  string.inharmonicity = inharmonicity;
  return {make_modal_basis(string), contact};
}

/// The model with every frequency off by a uniform share of at most `error`.
inline ModelPoint with_frequency_errors(ModelPoint point, double error, std::uint64_t seed) {
  std::vector<double> draw(point.basis.size());
  fill_uniform(StreamKey(seed).with("frequency errors"), draw);
  std::vector<double> frequencies;
  for (std::size_t n = 0; n < draw.size(); ++n) {
    frequencies.push_back(point.basis.frequency(n) * (1.0 + error * (2.0 * draw[n] - 1.0)));
  }
  point.basis = with_frequencies(std::move(point.basis), frequencies);
  return point;
}

/// Reactions R_r = H_r F of a sawtooth force at `pitch` [Hz] with a little noise: no truncation, so
/// that the model explains the data exactly.
inline CalibrationData exact_data(const ModelPoint& truth, std::size_t samples, double sample_rate,
                                  double pitch) {
  std::vector<double> force(samples);
  fill_standard_normal(StreamKey(7).with("force"), force);
  for (std::size_t j = 0; j < samples; ++j) {
    const double periods = pitch * static_cast<double>(j) / sample_rate;
    force[j] = 0.05 * force[j] + (periods - std::floor(periods)) - 0.5;
  }
  const std::vector<Complex> spectrum = RealFft(samples).forward(force);
  CalibrationData data{.samples = samples, .sample_rate = sample_rate};
  for (const End end : {End::kLeft, End::kRight}) {
    auto& reaction = data.reactions[static_cast<std::size_t>(end)];
    reaction = reaction_transfer(truth.basis, truth.contact, end, data.grid());
    for (std::size_t k = 0; k < reaction.size(); ++k) reaction[k] *= spectrum[k];
  }
  return data;
}

/// Reactions of the paper's bowed string, simulated and measured with noise of `noise_level` times
/// each signal's standard deviation.
inline CalibrationData bowed_data(double duration, double noise_level = 0.0,
                                  double time_step = 1e-6) {
  Scene scene = paper_scene();
  scene.duration = duration;
  const Simulation run =
      ModalExact({.time_step = time_step})
          .simulate(scene, 51200.0, {.left_reaction = true, .right_reaction = true});
  const Measurement measurement{.sample_rate = 51200.0, .noise_level = noise_level};
  const Signal left = measure(run.left_reaction, measurement, StreamKey(1).with("R1"));
  const Signal right = measure(run.right_reaction, measurement, StreamKey(1).with("R2"));
  return CalibrationData::of_records(left.samples, right.samples, 51200.0);
}

/// Median over the excited modes of |f_n/f_n(truth) − 1|.
inline double median_frequency_error(const ModelPoint& found, const ModelPoint& truth,
                                     const std::vector<bool>& excited) {
  std::vector<double> errors;
  for (std::size_t n = 0; n < excited.size(); ++n) {
    if (excited[n]) errors.push_back(std::abs(found.basis.omega[n] / truth.basis.omega[n] - 1.0));
  }
  return quantile(errors, 0.5);
}

}  // namespace modcal
