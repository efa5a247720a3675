// Bowed strings with converged truth for tests of the joint likelihood.
#pragma once

#include <cmath>

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

}  // namespace modcal
