#include "libsim/dynamics/plan.hpp"

#include <fmt/ranges.h>

#include <ctime>

#include "libsim/dynamics/scene/contact_modes.hpp"
#include "libsim/dynamics/tuning.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

template <typename Once>
double median_of_three(const Once& once) {
  std::vector<double> seconds;
  for (int i = 0; i < 3; ++i) seconds.push_back(once());
  return quantile(seconds, 0.5);
}

// What more the second of the two costs [s].
template <typename First, typename Second>
double difference(const First& first, const Second& second) {
  return median_of_three([&] {
    const double seconds = first();
    return second() - seconds;
  });
}

struct Timed {
  double seconds = 0.0;
  Simulation result;
};

// The first part of a record, timed, and what it is compared with.
struct Piece {
  const Simulator& simulator;
  const Scene& scene;
  double rate;
  const OutputRequest& outputs;
  double record_rate;   // the piece has more where many steps make a sample [Hz]
  double length = 0.0;  // [s]
  Simulation result{};

  Timed run(Scene other, double duration, double sample_rate, const OutputRequest& wanted) const {
    other.duration = duration;
    const double start = processor_seconds();
    Timed timed{.result = simulator.simulate(other, sample_rate, wanted)};
    timed.seconds = processor_seconds() - start;
    return timed;
  }
  double seconds(const Scene& other, double duration) const {
    return run(other, duration, rate, outputs).seconds;
  }
  // A record of two samples.
  double shortest() const { return 2.0 / rate; }
  // Ten thousand steps can be simulated in no time.
  double first_length() const {
    return std::max(shortest(), std::min(2e-3, 1e4 * simulator.longest_step()));
  }

  // Saving a second of the record, against `other` [s].
  template <typename Other>
  double saving(const Other& other) const {
    return difference([&] { return seconds(scene, length); }, other) / length;
  }
};

// A whole multiple of the sample rate at which at most a thousand steps make a sample [Hz].
double piece_rate(const Simulator& simulator, double sample_rate) {
  const double steps = 1.0 / (sample_rate * simulator.longest_step());
  return sample_rate * std::max(1.0, std::ceil(steps / 1000.0));
}

// A piece that costs a twentieth of the budget or is the whole record.
double fitting_length(const Piece& piece, double budget) {
  const double whole = piece.scene.duration;
  double length = std::min(whole, piece.first_length());
  while (length < whole && piece.seconds(piece.scene, length) < 0.05 * budget) {
    length = std::min(whole, 2.0 * length);
  }
  return length;
}

void add_blind_modes(const Piece& piece, std::vector<Skip>& skips) {
  if (piece.scene.bow.points > 1) return;  // what one point does not see another may
  std::vector<std::size_t> numbers;
  for (const std::size_t index : scene_modes(piece.scene).left_out) numbers.push_back(index + 1);
  if (numbers.empty()) return;
  const Scene carried = with_nodes_carried(piece.scene);
  const double saved = piece.saving([&] { return piece.seconds(carried, piece.length); });
  skips.push_back({fmt::format("modes {}", fmt::join(numbers, ", ")),
                   "they rest at a node of the contact: no force reaches them, and they reach "
                   "neither the contact nor the ends",
                   saved, "measured with the modes carried along"});
}

void add_unread_outputs(const Piece& piece, std::vector<Skip>& skips) {
  const OutputRequest& asked = piece.outputs;
  std::vector<std::string> names;
  for (const auto& [name, wanted] :
       {std::pair{"y", asked.displacement}, std::pair{"v", asked.velocity},
        std::pair{"f_c", asked.force}, std::pair{"R1", asked.left_reaction},
        std::pair{"R2", asked.right_reaction}}) {
    if (!wanted) names.emplace_back(name);
  }
  if (names.empty()) return;
  OutputRequest all = OutputRequest::all();
  all.switches_from = asked.switches_from;
  const double saved =
      piece.saving([&] { return piece.run(piece.scene, piece.length, piece.rate, all).seconds; });
  skips.push_back({fmt::format("output {}", fmt::join(names, ", ")), "nobody reads it", saved,
                   fmt::format("measured with all outputs, which take {:.3g} kB a second more",
                               8e-3 * piece.rate * static_cast<double>(names.size()))});
}

void add_reconstruction(const Piece& piece, std::vector<Skip>& skips) {
  const double step_rate = 1.0 / piece.result.time_step, per_sample = step_rate / piece.record_rate;
  if (per_sample < 1.5) return;
  const double saved = piece.saving(
      [&] { return piece.run(piece.scene, piece.length, step_rate, piece.outputs).seconds; });
  skips.push_back({"outputs between the samples",
                   fmt::format("{:.0f} steps make one sample", per_sample), saved,
                   "measured with a sample at every step"});
}

// Processor time of one evaluation of the sliding law [s].
double law_seconds(const Scene& scene) {
  const SlidingLaw law = scene.friction.make()->sliding(1.0);
  double speed = 0.0;
  const double start = processor_seconds();
  // Each call waits for the one before, as in a step loop.
  for (int i = 0; i < kTimedCalls; ++i) speed = 0.5 * sliding_force(law, speed);
  // The result is used, so that the loop is not left out itself.
  return std::isfinite(speed) ? (processor_seconds() - start) / kTimedCalls : 0.0;
}

void add_friction(const Piece& piece, double steps_per_second, std::vector<Skip>& skips) {
  double sticking = 0.0;
  for (std::size_t i = 0; i < piece.result.switches.size(); ++i) {
    const Switch& now = piece.result.switches[i];
    if (!now.attaches) continue;
    const bool is_last = i + 1 == piece.result.switches.size();
    sticking += (is_last ? piece.length : piece.result.switches[i + 1].time) - now.time;
  }
  if (sticking <= 0.0 || piece.scene.friction.make()->has_state()) return;
  const double share = sticking / piece.length;
  skips.push_back(
      {"the friction law during adherence",
       "a string that sticks is a linear system: spring and damper take its place",
       law_seconds(piece.scene) * steps_per_second * share,
       fmt::format("counted: {:.0f} % of the steps, one evaluation each", 100.0 * share)});
}

// Adds what the record costs in the scene with something more in it; nothing where the simulator
// refuses it.
void add_feature(const Piece& piece, const char* what, const char* reason, const Scene& with,
                 const char* note, std::vector<Skip>& skips) {
  double saved = 0.0;
  try {
    piece.seconds(with, piece.shortest());
    // Several times as slow as the scene itself: a part of it will do.
    const double length =
        std::min(piece.length, std::max(piece.first_length(), 0.1 * piece.length));
    saved = difference([&] { return piece.seconds(piece.scene, length); },
                       [&] { return piece.seconds(with, length); }) /
            length;
  } catch (const InvalidInput&) {
    note = "this simulator does not follow it: nothing to save";
  }
  skips.push_back({what, reason, saved, note});
}

// Physics that the scene does not ask for.
void add_features(const Piece& piece, std::vector<Skip>& skips) {
  const Scene& scene = piece.scene;
  if (scene.bow.normal_force == 0.0) return;  // no contact, of whatever kind
  if (!scene.torsion.present) {
    Scene with = scene;
    with.torsion.present = true;
    with.torsion.impedance_ratio = 1e16;
    add_feature(piece, "torsion", "scene.torsion is off", with,
                "measured with 20 torsional modes of 1e16 times the impedance, which move nothing",
                skips);
  }
  if (!scene.friction.make()->has_state()) {
    Scene with = scene;
    with.friction = Choice<FrictionLaw>("thermal");
    add_feature(piece, "temperature of the contact",
                "the friction law follows the sliding speed alone", with,
                "measured with scene.friction thermal", skips);
  }
  if (scene.bow.points == 1) {
    Scene with = scene;
    with.bow.points = 3;
    add_feature(piece, "width of the bow", "it has one contact point", with,
                "measured with 3 contact points in its place", skips);
  }
}

}  // namespace

Scene with_nodes_carried(Scene scene) {
  const std::vector<std::size_t> nodes = scene_modes(scene).left_out;
  const ModalBasis basis = make_modal_basis(scene.string);
  scene.initial = initial_state(scene, basis);
  scene.initial.displacement.resize(basis.size());
  scene.initial.velocity.resize(basis.size());
  for (const std::size_t index : nodes) scene.initial.velocity[index] = 1e-200;
  return scene;
}

SimulationPlan plan_simulation(const Scene& scene, const Simulator& simulator, double sample_rate,
                               const OutputRequest& outputs, double budget) {
  Piece piece{simulator, scene, piece_rate(simulator, sample_rate), outputs, sample_rate};
  SimulationPlan plan;
  plan.modes = static_cast<std::size_t>(scene.string.modes);
  plan.samples = sample_count(scene.duration, sample_rate);
  plan.set_up_seconds = median_of_three([&] { return piece.seconds(scene, piece.shortest()); });
  plan.piece = piece.length = fitting_length(piece, budget);
  OutputRequest listed = outputs;
  listed.switches_from = 0.0;
  Timed timed = piece.run(scene, plan.piece, piece.rate, listed);
  piece.result = std::move(timed.result);
  const double whole = plan.piece - piece.shortest();
  plan.seconds_per_second =
      whole > 0.0 ? std::max(0.0, timed.seconds - plan.set_up_seconds) / whole : 0.0;
  plan.modes_moved = piece.result.modes_moved;
  plan.time_step = piece.result.time_step;
  plan.steps_per_second = static_cast<double>(piece.result.steps) / plan.piece;
  add_blind_modes(piece, plan.skips);
  add_unread_outputs(piece, plan.skips);
  add_reconstruction(piece, plan.skips);
  add_friction(piece, plan.steps_per_second, plan.skips);
  add_features(piece, plan.skips);
  return plan;
}

}  // namespace modcal
