// Bowed strings with converged truth for tests of the joint likelihood.
#pragma once

#include <cmath>
#include <complex>
#include <numbers>

#include "libcalib/likelihood/projected_likelihood.hpp"
#include "libsim/base/random.hpp"
#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {

struct BowedCase {
  ModelPoint truth;
  std::array<std::vector<double>, 2> clean;  ///< means removed [N]
  std::array<double, 2> spread{};            ///< standard deviations [N]
};

inline BowedCase bowed_case(double contact, double inharmonicity, double duration) {
  Scene scene = paper_scene();
  scene.bow.position = contact;
  scene.string.inharmonicity = inharmonicity;
  scene.duration = duration;
  const Simulation run =
      ModalEvent({}).simulate(scene, 51200.0, {.left_reaction = true, .right_reaction = true});
  BowedCase result{.truth = {make_modal_basis(scene.string), contact},
                   .clean = {run.left_reaction.samples, run.right_reaction.samples}};
  for (std::size_t r = 0; r < 2; ++r) {
    remove_mean(result.clean[r]);
    result.spread[r] = standard_deviation(result.clean[r]);
  }
  return result;
}

/// Records with white noise of `level` times each signal's standard deviation; draw: whether the
/// noise is there or only stated.
inline NoisyRecords noisy(const BowedCase& bowed, double level, std::uint64_t seed,
                          bool draw = true) {
  NoisyRecords records{.reactions = bowed.clean,
                       .deviation = {level * bowed.spread[0], level * bowed.spread[1]},
                       .sample_rate = 51200.0};
  for (std::size_t r = 0; draw && r < 2; ++r) {
    std::vector<double> noise(records.samples());
    fill_standard_normal(StreamKey(seed).with(std::uint64_t{r}), noise);
    for (std::size_t j = 0; j < noise.size(); ++j) {
      records.reactions[r][j] += records.deviation[r] * noise[j];
    }
    remove_mean(records.reactions[r]);
  }
  return records;
}

/// Two first-order processes of variance 1, the second with a share of the first.
inline NoisyRecords with_colored_noise(const BowedCase& bowed, double level, std::uint64_t seed) {
  NoisyRecords records = noisy(bowed, level, seed, false);
  std::vector<double> first(records.samples()), second(records.samples());
  fill_standard_normal(StreamKey(seed).with(std::uint64_t{0}), first);
  fill_standard_normal(StreamKey(seed).with(std::uint64_t{1}), second);
  double state = 0.0;
  for (std::size_t j = 0; j < first.size(); ++j) {
    state = 0.9 * state + 0.3 * first[j];
    records.reactions[0][j] += records.deviation[0] * (state + first[j]);
    records.reactions[1][j] += records.deviation[1] * (0.6 * (state + first[j]) + second[j]);
  }
  for (auto& reaction : records.reactions) remove_mean(reaction);
  return records;
}
/// Their covariance, |1 + 0.3/(1 − 0.9 z⁻¹)|² the power of the first.
inline NoiseSpectrum colored_spectrum() {
  NoiseSpectrum spectrum;
  double f = 50.0;
  while (f < 11000.0) {
    const double power =
        std::norm(1.0 + 0.3 / (1.0 - 0.9 * std::polar(1.0, -2.0 * std::numbers::pi * f / 51200.0)));
    spectrum.knots.push_back({f, {power, 0.36 * power + 1.0, 0.6 * power}});
    f *= 1.1;
  }
  return spectrum;
}

}  // namespace modcal
