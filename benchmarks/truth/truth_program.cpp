// truth: a record of a string that modcal has not made, and what is true of it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "benchmarks/truth/truth_files.hpp"

namespace {

using namespace modcal::truth;

/// What the command line states; courses as "0:0.1,0.5:0.2" or "0.1".
struct Stated {
  TruthString string;
  TruthTorsion torsion;
  TruthOptions options;
  ExponentialFriction exponential;
  ThermalFriction thermal;
  TruthPluck pluck;
  double position = 0.041;
  std::string action = "exponential", reactions = "tension", output;
  std::string velocity = "0.1", normal_force = "0.5", force = "0:0,0.02:0.5,0.0205:0";
  std::vector<double> noise = {0.0};
  bool has_torsion = false, plain = false;
};

Course course_of(const std::string& text) {
  Course course;
  for (const std::string& part : CLI::detail::split(text, ',')) {
    const std::size_t colon = part.find(':');
    Knot knot{.time = 0.0, .value = 0.0};
    const bool timed = colon != std::string::npos;
    if ((timed && !CLI::detail::lexical_cast(part.substr(0, colon), knot.time)) ||
        !CLI::detail::lexical_cast(timed ? part.substr(colon + 1) : part, knot.value) ||
        (!course.empty() && !(knot.time > course.back().time))) {
      throw std::invalid_argument(fmt::format(
          "\"{}\": a number, or times and values that follow each other, 0:0.1,0.5:0.2", text));
    }
    course.push_back(knot);
  }
  return course;
}

void add_string_options(CLI::App& app, Stated& s) {
  app.add_option("--f0", s.string.fundamental, "f0 of the string without stiffness [Hz]");
  app.add_option("--B", s.string.inharmonicity, "inharmonicity [1]");
  app.add_option("--length", s.string.length, "L [m]");
  app.add_option("--density", s.string.linear_density, "linear density [kg/m]");
  app.add_option("--loss", s.string.loss, "s0 of sigma = s0 + s1 (n pi/L)^2 [1/s]");
  app.add_option("--diffusion", s.string.diffusion, "s1 [m^2/s]");
  app.add_flag("--torsion", s.has_torsion, "the bow also turns the string");
  app.add_option("--torsion-speed", s.torsion.speed_ratio, "wave speed over the transverse one");
  app.add_option("--torsion-impedance", s.torsion.impedance_ratio,
                 "impedance over the transverse one");
  app.add_option("--torsion-loss", s.torsion.loss, "s0 of torsion [1/s]");
  app.add_option("--torsion-diffusion", s.torsion.diffusion, "s1 of torsion [m^2/s]");
}

void add_gesture_options(CLI::App& app, Stated& s) {
  app.add_option("--x", s.position, "contact x_c from the end of R1 [m]");
  app.add_option("--action", s.action, "what moves the string")
      ->check(CLI::IsMember({"exponential", "thermal", "force", "pluck"}));
  app.add_option("--velocity", s.velocity, "bow velocity [m/s]: value, or time:value,...");
  app.add_option("--normal-force", s.normal_force, "normal force [N]: value, or time:value,...");
  app.add_option("--static", s.exponential.static_coefficient, "exponential: mu_S");
  app.add_option("--dynamic", s.exponential.dynamic_coefficient, "exponential: mu_D");
  app.add_option("--decay", s.exponential.decay, "exponential: C [s/m]");
  app.add_option("--cold", s.thermal.cold_coefficient, "thermal: mu when cold");
  app.add_option("--hot", s.thermal.hot_coefficient, "thermal: mu when hot");
  app.add_option("--softening-rise", s.thermal.softening_rise, "thermal: [K]");
  app.add_option("--softening-width", s.thermal.softening_width, "thermal: [K]");
  app.add_option("--heat-capacity", s.thermal.heat_capacity, "thermal: [J/K]");
  app.add_option("--conductance", s.thermal.conductance, "thermal: [W/K]");
  app.add_option("--carried-heat", s.thermal.carried_heat, "thermal: [J/(K m)]");
  app.add_option("--force", s.force, "force: on the string [N], time:value,...");
  app.add_option("--height", s.pluck.height, "pluck: how far the string is drawn aside [m]");
  app.add_option("--width", s.pluck.width, "pluck: of the finger [m]");
}

void add_record_options(CLI::App& app, Stated& s) {
  app.add_option("output", s.output, "writes OUTPUT.csv and OUTPUT.json")->required();
  app.add_option("--duration", s.options.duration, "[s]");
  app.add_option("--rate", s.options.sample_rate, "sample rate of the record [Hz]");
  app.add_option("--start", s.options.start,
                 "the record begins this long after the gesture; negative: before it [s]");
  app.add_option("--reactions", s.reactions, "tension: -T y'; support: -T y' + EI y'''")
      ->check(CLI::IsMember({"tension", "support"}));
  app.add_flag("--no-filter", s.plain, "plain samples, no anti-alias filter");
  app.add_option(
         "--noise", s.noise,
         "white noise over the standard deviation of a reaction; several, A,B: OUTPUT-A.csv "
         "... of one simulation")
      ->delimiter(',');
  app.add_option("--seed", s.options.seed, "of the noise");
  app.add_option("--least-rate", s.options.least_rate, "of the scheme [Hz]");
  app.add_option("--intervals", s.options.intervals, "cells; 0: by the sample rate");
  app.add_option("--half-width", s.options.half_width, "of the stencil: 2, 4 or 8");
  app.add_flag("--audit", s.options.audit, "checks energy and friction at every step");
}

void add_mismatch_options(CLI::App& app, TruthMismatch& m) {
  app.add_option("--gain", m.gain, "of the sensor at x = L over that at x = 0");
  app.add_option("--delay", m.delay, "of the sensor at x = L [s]");
  app.add_option("--corner", m.corner, "of the sensor at x = L [Hz]");
  app.add_option("--body-peak", m.body_peak, "of a resonance in the sensor at x = L");
  app.add_option("--body-frequency", m.body_frequency, "[Hz]");
  app.add_option("--body-damping", m.body_damping, "zeta");
  app.add_option("--polarization-1", m.polarization[0], "share of the second polarization in R1");
  app.add_option("--polarization-2", m.polarization[1], "share of the second polarization in R2");
  app.add_option("--detuning", m.detuning, "of the second polarization");
  app.add_option("--drift", m.drift, "relative change of f0 over the record");
  app.add_option("--wander", m.wander, "of the contact along the string [m]");
  app.add_option("--wander-frequency", m.wander_frequency, "0: a slope over the record [Hz]");
  app.add_option(
      "--bridge-mass", m.bridge_mass,
      "of a mode of the body, of the body's frequency and damping, that x = L is on [kg]");
}

TruthGesture gesture_of(const Stated& s) {
  TruthGesture gesture{.position = s.position, .action = s.pluck};
  if (s.action == "force") gesture.action = TruthForce{.force = course_of(s.force)};
  if (s.action == "exponential" || s.action == "thermal") {
    TruthBow bow{.velocity = course_of(s.velocity),
                 .normal_force = course_of(s.normal_force),
                 .friction = s.exponential};
    if (s.action == "thermal") bow.friction = s.thermal;
    gesture.action = bow;
  }
  return gesture;
}

void run(Stated& s) {
  if (s.has_torsion) s.string.torsion = s.torsion;
  s.options.filtered = !s.plain;
  if (s.reactions == "support") s.options.reactions = Reactions::kSupport;
  const TruthGesture gesture = gesture_of(s);
  const TruthRecord clean = simulate(s.string, gesture, s.options);
  for (const double level : s.noise) {
    const std::string name =
        s.noise.size() > 1 ? fmt::format("{}-{:g}", s.output, level) : s.output;
    TruthRecord record = clean;
    TruthOptions options = s.options;
    options.noise_level = level;
    if (level > 0.0) add_noise(record, level, options.seed);
    write_record(name + ".csv", record);
    write_truth(name + ".json", s.string, gesture, options, record);
  }
  fmt::print("{} cells at {:g} MHz, stuck {:.1f} %, {} slips\n", clean.intervals,
             1e-6 * clean.internal_rate, 100.0 * clean.stuck, clean.slips);
  if (s.options.audit) {
    fmt::print("energy {:.1e} of {:.3g} J, friction off its set by {:.1e} of the normal force\n",
               clean.audit.residual(), clean.audit.largest, clean.audit.friction_violation);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Record of a bowed or plucked string by finite differences, and what is true of it."};
  app.option_defaults()->always_capture_default();
  Stated stated;
  add_string_options(app, stated);
  add_gesture_options(app, stated);
  add_record_options(app, stated);
  add_mismatch_options(app, stated.options.mismatch);
  CLI11_PARSE(app, argc, argv);
  try {
    run(stated);
  } catch (const std::exception& error) {
    fmt::print(stderr, "truth: {}\n", error.what());
    return 1;
  }
  return 0;
}
