// Plucked strings with converged truth for tests of the joint likelihood.
#pragma once

#include "libcalib/likelihood/records/whitened_record.hpp"
#include "libsim/base/random.hpp"
#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/scene/scene.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {

/// Reactions of the paper's string plucked 43 mm from its end, white noise of `level` times each
/// signal's standard deviation.
inline NoisyRecords plucked_records(double inharmonicity, double duration, double level,
                                    std::uint64_t seed, std::int64_t modes = 50) {
  Scene scene = paper_scene();
  scene.string.inharmonicity = inharmonicity;
  scene.string.modes = modes;
  scene.bow.velocity = 0.0;
  scene.bow.normal_force = 0.0;
  scene.duration = duration;
  scene.start = Choice<InitialMotion>::of<Pluck>(
      "pluck", {.position = 0.043, .displacement = 1e-3, .width = 3e-3});
  const Simulation run =
      ModalEvent({}).simulate(scene, 51200.0, {.left_reaction = true, .right_reaction = true});
  NoisyRecords records{.reactions = {run.left_reaction.samples, run.right_reaction.samples},
                       .sample_rate = 51200.0};
  for (std::size_t r = 0; r < 2; ++r) {
    records.deviation[r] = level * standard_deviation(records.reactions[r]);
    std::vector<double> noise(records.samples());
    fill_standard_normal(StreamKey(seed).with("pluck").with(std::uint64_t{r}), noise);
    for (std::size_t j = 0; seed != 0 && j < noise.size(); ++j) {
      records.reactions[r][j] += records.deviation[r] * noise[j];
    }
    remove_mean(records.reactions[r]);
  }
  return records;
}

}  // namespace modcal
