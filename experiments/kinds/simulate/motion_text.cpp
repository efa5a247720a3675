#include "experiments/kinds/simulate/motion_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libsim/dynamics/scene/string_regime.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr double kSlipping = 0.5;  // of the bow's velocity: a string that sticks differs by less
constexpr double kSteady = 0.1;    // of the bow's speed and force: hands that tremble do no more

// Switches by the velocity alone: with friction laws that have none the string sticks, too.
std::vector<Switch> switches_of(const Signal& velocity, double bow_velocity) {
  std::vector<Switch> switches;
  double displacement = 0.0;
  for (std::size_t k = 0; k < velocity.size(); ++k) {
    const double v = velocity.samples[k];
    const bool sticks = std::abs(v - bow_velocity) < kSlipping * std::abs(bow_velocity);
    if (switches.empty() || sticks != switches.back().attaches) {
      switches.push_back({.time = static_cast<double>(k) / velocity.sample_rate,
                          .displacement = displacement,
                          .attaches = sticks});
    }
    displacement += v / velocity.sample_rate;
  }
  return switches;
}

// Whether a bow's speed or force is the same from `start` to `end`, and what it is in the end.
struct Held {
  double value = 0.0;
  bool steady = false;
};
Held held_value(const PiecewiseLinear& stroke, double start, double end) {
  const double last = stroke.at(end), most = std::max(stroke.highest(), -stroke.lowest());
  bool steady = true;
  double t = start;
  while (t < end) {
    steady = steady && std::abs(stroke.at(t) - last) <= kSteady * most;
    t = stroke.next_knot(t);
  }
  return {std::abs(last) <= kSteady * most ? 0.0 : last, steady};
}

std::string decay_text(const Signal& velocity, double start, double frequency) {
  const auto first = velocity.samples.begin() +
                     static_cast<std::ptrdiff_t>(std::ceil(start * velocity.sample_rate));
  const auto middle = first + (velocity.samples.end() - first) / 2;
  const double fall = 20.0 * std::log10(standard_deviation({first, middle}) /
                                        standard_deviation({middle, velocity.samples.end()}));
  const double half = static_cast<double>(middle - first) / velocity.sample_rate;
  return fmt::format("The string rings freely at {:.5g} Hz, falling by {:.3g} dB a second",
                     frequency, fall / half);
}

std::string regime_text(const RegimeFeatures& found, double frequency) {
  const std::string slips =
      fmt::format("sticking for {:.0f} % of the time", 100.0 * found.adherence);
  switch (classify(found, {})) {
    case StringRegime::kHelmholtz:
      return fmt::format("Helmholtz motion at {:.5g} Hz: one slip a period, {}", frequency, slips);
    case StringRegime::kMultipleSlip:
      return fmt::format("Multiple slip at {:.5g} Hz: {:.2g} slips a period, {}", frequency,
                         found.slips_per_period, slips);
    case StringRegime::kRaucous:
      return fmt::format("Raucous motion: {:.2g} slips in a period of the string, {}",
                         found.slips_per_period, slips);
    case StringRegime::kSilent:
      break;
  }
  return found.slips_per_period == 0.0 && found.adherence > 0.5
             ? "The bow holds the string without a slip"
             : fmt::format("The string slides under the bow, {}", slips);
}

}  // namespace

std::string motion_text(const Scene& scene, const Simulation& simulation) {
  const Signal& velocity = simulation.velocity;
  const double start = judged_from(scene, {}), end = scene.duration;
  if (start < 0.0) {
    return fmt::format("What the string settles in takes {:.2g} s to tell; this is {:g} s of it",
                       end - start, end);
  }
  const BowMotion bow = bow_motion(scene.bow, end);
  const Held speed = held_value(bow.velocity, start, end);
  const Held force = held_value(bow.normal_force, start, end);
  const bool is_free = force.steady && force.value == 0.0;
  if (!is_free && !(speed.steady && force.steady)) {
    return fmt::format("The bow changes until the end: the last {:.2g} s are of no one motion",
                       end - start);
  }
  if (is_free) {
    const StringModel& string = scene.string;
    return decay_text(velocity, start,
                      stiff_string_frequency(string.fundamental, string.inharmonicity, 1));
  }
  if (speed.value == 0.0) return "The bow stands still on the string";
  Scene steady = scene;
  steady.bow.velocity = speed.value;
  Simulation judged;
  judged.velocity = velocity;
  judged.switches = switches_of(velocity, steady.bow.velocity);
  const RegimeFeatures found = regime_features(steady, judged, {});
  std::string text = regime_text(found, scene.string.fundamental / found.period);
  if (const Signal& friction = simulation.force; !friction.samples.empty()) {
    const auto first = friction.samples.begin() +
                       static_cast<std::ptrdiff_t>(std::ceil(start * friction.sample_rate));
    const auto [low, high] = std::minmax_element(first, friction.samples.end());
    text += fmt::format("; friction force from {:.2g} to {:.2g} N under {:.3g} N of the bow", *low,
                        *high, force.value);
  }
  return text;
}

}  // namespace modcal
