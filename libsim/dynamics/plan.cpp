#include "libsim/dynamics/plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>
#include <variant>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Pieces of one simulation, timed.
class Pieces {
 public:
  Pieces(const Simulator& simulator, double sample_rate, double duration, double budget)
      : simulator_(simulator), rate_(sample_rate), duration_(duration), budget_(budget) {}

  struct Timed {
    double seconds = 0.0;
    Simulation result;
  };
  Timed run(Scene scene, double length, double rate, const OutputRequest& outputs) const {
    scene.duration = length;
    const double start = processor_seconds();
    Timed timed{.result = simulator_.simulate(scene, rate, outputs)};
    timed.seconds = processor_seconds() - start;
    return timed;
  }

  // A record of two samples.
  double set_up(const Scene& scene, const OutputRequest& outputs) const {
    return median_of_three([&] { return run(scene, 2.0 / rate_, rate_, outputs).seconds; });
  }

  // A piece that costs a twentieth of the budget or is the whole record.
  double fitting_length(const Scene& scene, const OutputRequest& outputs) const {
    double length = std::min(duration_, std::max(2.0 / rate_, 2e-3));
    while (length < duration_ && run(scene, length, rate_, outputs).seconds < 0.05 * budget_) {
      length = std::min(duration_, 2.0 * length);
    }
    return length;
  }

  // What more the second of the two costs, over the first piece of the record [s].
  template <typename First, typename Second>
  static double difference(const First& first, const Second& second) {
    std::vector<double> differences;
    for (int i = 0; i < 3; ++i) {
      const double seconds = first();
      differences.push_back(second() - seconds);
    }
    return quantile(differences, 0.5);
  }

  double rate() const { return rate_; }

 private:
  template <typename Run>
  static double median_of_three(const Run& once) {
    std::vector<double> seconds;
    for (int i = 0; i < 3; ++i) seconds.push_back(once());
    return quantile(seconds, 0.5);
  }

  const Simulator& simulator_;
  double rate_, duration_, budget_;
};

// The piece that everything is compared with.
struct Base {
  const Pieces& pieces;
  const Scene& scene;
  const OutputRequest& outputs;
  double length;
  const Simulation& result;

  double seconds() const { return pieces.run(scene, length, pieces.rate(), outputs).seconds; }
  // Saving a second of the record, against `other` [s].
  template <typename Other>
  double saving(const Other& other) const {
    return Pieces::difference([&] { return seconds(); }, other) / length;
  }
};

void add_blind_modes(const Base& base, std::vector<Skip>& skips) {
  if (base.scene.bow.points > 1) return;  // what one point does not see another may
  std::vector<std::size_t> numbers;
  for (const std::size_t index : scene_modes(base.scene).left_out) numbers.push_back(index + 1);
  if (numbers.empty()) return;
  const Scene carried = with_nodes_carried(base.scene);
  const double saved = base.saving([&] {
    return base.pieces.run(carried, base.length, base.pieces.rate(), base.outputs).seconds;
  });
  skips.push_back({fmt::format("modes {}", fmt::join(numbers, ", ")),
                   "they rest at a node of the contact: no force reaches them, and they reach "
                   "neither the contact nor the ends",
                   saved, "measured with the modes carried along"});
}

void add_unread_outputs(const Base& base, std::vector<Skip>& skips) {
  const OutputRequest& asked = base.outputs;
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
  const double saved = base.saving(
      [&] { return base.pieces.run(base.scene, base.length, base.pieces.rate(), all).seconds; });
  skips.push_back({fmt::format("output {}", fmt::join(names, ", ")), "nobody reads it", saved,
                   fmt::format("measured with all outputs, which take {:.3g} kB a second more",
                               8e-3 * base.pieces.rate() * static_cast<double>(names.size()))});
}

void add_reconstruction(const Base& base, std::vector<Skip>& skips) {
  const double per_sample = 1.0 / (base.result.time_step * base.pieces.rate());
  if (per_sample < 1.5) return;
  const double saved = base.saving([&] {
    return base.pieces.run(base.scene, base.length, 1.0 / base.result.time_step, base.outputs)
        .seconds;
  });
  skips.push_back({"outputs between the samples",
                   fmt::format("{:.0f} steps make one sample", per_sample), saved,
                   "measured with a sample at every step"});
}

// Processor time of one evaluation of the sliding law [s].
double law_seconds(const Scene& scene) {
  const SlidingLaw law = scene.friction.make()->sliding(1.0);
  constexpr int kCalls = 20000;
  double speed = 0.0;
  const double start = processor_seconds();
  // Each call waits for the one before, as in a step loop.
  for (int i = 0; i < kCalls; ++i) {
    speed = 0.5 * std::visit([speed](const auto& l) { return l.at(speed).force; }, law);
  }
  // The result is used, so that the loop is not left out itself.
  return std::isfinite(speed) ? (processor_seconds() - start) / kCalls : 0.0;
}

void add_friction(const Base& base, double steps_per_second, std::vector<Skip>& skips) {
  double sticking = 0.0;
  for (std::size_t i = 0; i < base.result.switches.size(); ++i) {
    const Switch& now = base.result.switches[i];
    if (!now.attaches) continue;
    const bool is_last = i + 1 == base.result.switches.size();
    sticking += (is_last ? base.length : base.result.switches[i + 1].time) - now.time;
  }
  if (sticking <= 0.0 || base.scene.friction.make()->has_state()) return;
  const double share = sticking / base.length;
  skips.push_back(
      {"the friction law during adherence",
       "a string that sticks is a linear system: spring and damper take its place",
       law_seconds(base.scene) * steps_per_second * share,
       fmt::format("counted: {:.0f} % of the steps, one evaluation each", 100.0 * share)});
}

// What the same part of the record costs in the scene with something more in it [s a second];
// nothing where this simulator refuses it.
std::optional<double> cost_of(const Base& base, const Scene& with) {
  try {
    base.pieces.run(with, 2.0 / base.pieces.rate(), base.pieces.rate(), base.outputs);
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
  // Several times as slow as the scene itself: a part of it will do.
  const double length = std::min(base.length, std::max(2e-3, 0.1 * base.length));
  const auto timed = [&](const Scene& scene) {
    return base.pieces.run(scene, length, base.pieces.rate(), base.outputs).seconds;
  };
  return Pieces::difference([&] { return timed(base.scene); }, [&] { return timed(with); }) /
         length;
}

void add_feature(const Base& base, const char* what, const char* reason, const Scene& with,
                 const char* note, std::vector<Skip>& skips) {
  const std::optional<double> saved = cost_of(base, with);
  skips.push_back({what, reason, saved.value_or(0.0),
                   saved ? note : "this simulator does not follow it: nothing to save"});
}

// Physics that the scene does not ask for.
void add_features(const Base& base, std::vector<Skip>& skips) {
  const Scene& scene = base.scene;
  if (scene.bow.normal_force == 0.0) return;  // no contact, of whatever kind
  if (!scene.torsion.present) {
    Scene with = scene;
    with.torsion.present = true;
    with.torsion.impedance_ratio = 1e16;
    add_feature(base, "torsion", "scene.torsion is off", with,
                "measured with 20 torsional modes of 1e16 times the impedance, which move nothing",
                skips);
  }
  if (!scene.friction.make()->has_state()) {
    Scene with = scene;
    with.friction = Choice<FrictionLaw>("thermal");
    add_feature(base, "temperature of the contact",
                "the friction law follows the sliding speed alone", with,
                "measured with scene.friction thermal", skips);
  }
  if (scene.bow.points == 1) {
    Scene with = scene;
    with.bow.points = 3;
    add_feature(base, "width of the bow", "it has one contact point", with,
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
  const Pieces pieces(simulator, sample_rate, scene.duration, budget);
  SimulationPlan plan;
  plan.modes = static_cast<std::size_t>(scene.string.modes);
  plan.samples = sample_count(scene.duration, sample_rate);
  plan.set_up_seconds = pieces.set_up(scene, outputs);
  plan.piece = pieces.fitting_length(scene, outputs);
  OutputRequest listed = outputs;
  listed.switches_from = 0.0;
  const Pieces::Timed timed = pieces.run(scene, plan.piece, sample_rate, listed);
  const double whole = plan.piece - 2.0 / sample_rate;
  plan.seconds_per_second =
      whole > 0.0 ? std::max(0.0, timed.seconds - plan.set_up_seconds) / whole : 0.0;
  plan.modes_moved = timed.result.modes_moved;
  plan.time_step = timed.result.time_step;
  plan.steps_per_second = static_cast<double>(timed.result.steps) / plan.piece;
  const Base base{pieces, scene, outputs, plan.piece, timed.result};
  add_blind_modes(base, plan.skips);
  add_unread_outputs(base, plan.skips);
  add_reconstruction(base, plan.skips);
  add_friction(base, plan.steps_per_second, plan.skips);
  add_features(base, plan.skips);
  return plan;
}

}  // namespace modcal
