// What a calibration says of modes that leave the law of the others: false alarms on strings that
// follow it, and a single mode that does not, each of the 50 in its turn.
//
//     leaving_modes [DRAWS]
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>

#include "libcalib/optimizers/staged/continuation.hpp"
#include "libsim/base/random.hpp"
#include "libsim/base/task_loop.hpp"
#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/model/transfer.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr double kRate = 51200.0;
constexpr std::size_t kModes = 50;

Scene scene_of(double contact, double inharmonicity) {
  Scene scene;
  scene.string = {.length = 0.33, .linear_density = 3.1e-3, .fundamental = 196.0};
  scene.string.inharmonicity = inharmonicity;
  scene.bow.position = contact;
  return scene;
}

struct Case {
  ModelPoint truth;
  std::array<std::vector<double>, 2> reactions;
};

// The reactions to the force of a bowed string of another whose mode n is off by `departure`: eight
// seconds of decay, after which the first mode is down to 5e-5 where the transform wraps.
Case make_case(const Scene& scene, const Signal& force, std::size_t n, double departure) {
  Case result{.truth = {make_modal_basis(scene.string), scene.bow.position}};
  result.truth.basis.omega[n] *= 1.0 + departure;
  std::vector<double> padded(8 * force.samples.size());
  std::copy(force.samples.begin(), force.samples.end(), padded.begin());
  const RealFft fft(padded.size());
  const std::vector<Complex> spectrum = fft.forward(padded);
  const FrequencyGrid grid = FrequencyGrid::of_record(padded.size(), kRate);
  for (const End end : {End::kLeft, End::kRight}) {
    std::vector<Complex> reaction =
        reaction_transfer(result.truth.basis, scene.bow.position, end, grid);
    for (std::size_t k = 0; k < reaction.size(); ++k) reaction[k] *= spectrum[k];
    std::vector<double>& samples = result.reactions[static_cast<std::size_t>(end)];
    samples = fft.inverse(std::move(reaction));
    samples.resize(force.samples.size());
    remove_mean(samples);
  }
  return result;
}

ContinuationResult calibrate(const Case& bowed, double level, std::uint64_t draw) {
  const StreamKey key = StreamKey(draw).with("leaving");
  ContinuationOptions options;
  std::array<std::vector<double>, 2> noisy = bowed.reactions;
  std::array<double, 2> deviation{};
  for (std::size_t r = 0; r < 2; ++r) {
    deviation[r] = level * standard_deviation(noisy[r]);
    std::vector<double> noise(noisy[r].size());
    fill_standard_normal(key.with(std::uint64_t{r}), noise);
    for (std::size_t j = 0; j < noise.size(); ++j) noisy[r][j] += deviation[r] * noise[j];
    remove_mean(noisy[r]);
  }
  options.left_noise = deviation[0];
  options.right_noise = deviation[1];
  ModelPoint start = bowed.truth;
  std::vector<double> uniform(kModes + 1);
  fill_uniform(key.with("start"), uniform);
  for (std::size_t n = 0; n < kModes; ++n) {
    start.basis.omega[n] *= 1.0 + 0.02 * (2.0 * uniform[n] - 1.0);
  }
  start.contact += 1.5e-3 * (2.0 * uniform.back() - 1.0);
  return calibrate_by_continuation(start, CalibrationData::of_records(noisy[0], noisy[1], kRate),
                                   options);
}

struct Count {
  std::size_t strings = 0, accepted = 0, right = 0, leaves = 0, doubtful = 0, wrong = 0;
  // Of the one mode that is off:
  std::size_t found = 0, doubted = 0, from_law = 0, drawn = 0, contradicted = 0;
};

// Identified, and off by more than six standard deviations where the data alone would have it so.
bool is_wrong(const ModeVerdict& mode, double truth) {
  return mode.source == ModeSource::kIdentified &&
         std::abs(mode.frequency / truth - 1.0) > 6.0 * mode.deviation;
}

void add(const ContinuationResult& result, const ModelPoint& truth, std::size_t off, Count& count) {
  ++count.strings;
  count.accepted += result.law.accepted ? 1 : 0;
  count.right += result.right ? 1 : 0;
  for (std::size_t n = 0; n < kModes; ++n) {
    const ModeVerdict& mode = result.modes[n];
    const bool wrong = is_wrong(mode, truth.basis.frequency(n));
    if (n == off) {
      const bool leaves = mode.tie == LawTie::kLeaves;
      count.contradicted += result.right ? 0 : 1;
      if (!result.right) continue;
      count.found += leaves && !wrong ? 1 : 0;
      count.doubted += mode.tie == LawTie::kDoubtful ? 1 : 0;
      count.from_law +=
          mode.tie == LawTie::kFollows && mode.source != ModeSource::kIdentified ? 1 : 0;
      count.drawn += mode.tie == LawTie::kFollows && mode.source == ModeSource::kIdentified ? 1 : 0;
      count.wrong += leaves && wrong ? 1 : 0;
      continue;
    }
    count.leaves += mode.tie == LawTie::kLeaves ? 1 : 0;
    count.doubtful += mode.tie == LawTie::kDoubtful ? 1 : 0;
    count.wrong += wrong ? 1 : 0;
  }
}

Count sum(const std::vector<Count>& counts) {
  Count total;
  for (const Count& count : counts) {
    for (std::size_t Count::*const member :
         {&Count::strings, &Count::accepted, &Count::right, &Count::leaves, &Count::doubtful,
          &Count::wrong, &Count::found, &Count::doubted, &Count::from_law, &Count::drawn,
          &Count::contradicted}) {
      total.*member += count.*member;
    }
  }
  return total;
}

void follow(std::size_t draws) {
  fmt::print("strings that follow their law\n{:>8} {:>8} {:>8} {:>8} {:>8} {:>10} {:>10} {:>8}\n",
             "x_c mm", "B", "noise %", "strings", "right", "leave", "doubtful", "wrong");
  for (const auto& [contact, inharmonicity] :
       {std::pair{0.03, 0.0}, std::pair{0.0285, 1.39e-4}, std::pair{0.03, 4e-4}}) {
    const Scene scene = scene_of(contact, inharmonicity);
    const Simulation run =
        ModalEvent({}).simulate(scene, kRate, {.left_reaction = true, .right_reaction = true});
    Case bowed{.truth = {make_modal_basis(scene.string), contact},
               .reactions = {run.left_reaction.samples, run.right_reaction.samples}};
    for (std::vector<double>& samples : bowed.reactions) remove_mean(samples);
    for (const double level : {0.01, 0.1}) {
      std::vector<Count> counts(draws);
      for_each_task(draws, [&](std::size_t d) {
        add(calibrate(bowed, level, d), bowed.truth, kModes, counts[d]);
      });
      const Count all = sum(counts);
      fmt::print("{:>8} {:>8} {:>8} {:>8} {:>8} {:>10} {:>10} {:>8}\n", 1e3 * contact,
                 inharmonicity, 100.0 * level, all.strings, all.right, all.leaves, all.doubtful,
                 all.wrong);
    }
  }
}

void leave() {
  const Scene scene = scene_of(0.0285, 0.0);
  const Simulation run = ModalEvent({}).simulate(scene, kRate, {.force = true});
  fmt::print(
      "\none of 50 modes off the law, each in its turn; law: how often chi2 accepts it at first or "
      "without the mode\n{:>8} {:>8} {:>6} {:>7} {:>9} {:>9} {:>9} {:>13} {:>8} {:>8}\n",
      "off %", "noise %", "law", "found", "doubtful", "from law", "drawn", "contradicted", "wrong",
      "others");
  for (const double departure : {0.002, 0.004, 0.006}) {
    for (const double level : {0.001, 0.01, 0.03, 0.1}) {
      std::vector<Count> counts(kModes);
      for_each_task(kModes, [&](std::size_t n) {
        const Case bowed = make_case(scene, run.force, n, departure);
        add(calibrate(bowed, level, 100 + n), bowed.truth, n, counts[n]);
      });
      const Count all = sum(counts);
      fmt::print("{:>8} {:>8} {:>6} {:>7} {:>9} {:>9} {:>9} {:>13} {:>8} {:>8}\n",
                 100.0 * departure, 100.0 * level, all.accepted, all.found, all.doubted,
                 all.from_law, all.drawn, all.contradicted, all.wrong, all.leaves);
    }
  }
}

}  // namespace
}  // namespace modcal

int main(int count, char** arguments) {
  const std::size_t draws = count > 1 ? std::strtoul(arguments[1], nullptr, 10) : 20;
  modcal::follow(draws);
  modcal::leave();
}
