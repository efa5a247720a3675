#include "experiments/kinds/simulate/structure_scene.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "experiments/kinds/lint.hpp"
#include "experiments/kinds/lint_bow.hpp"
#include "experiments/kinds/structure/structure_files.hpp"
#include "libsim/signal/decimation.hpp"

namespace modcal {
namespace {

struct StructureBow {
  Bow& bow;
  void visit(OptionVisitor& visitor) {
    bow.visit_levels(visitor);
    bow.visit_course(visitor);
  }
};

// By name, or by number from 1.
std::size_t sensor_named(const std::string& name, const StructureTable& table) {
  const auto found = std::ranges::find(table.names, name);
  if (found != table.names.end()) return static_cast<std::size_t>(found - table.names.begin());
  std::size_t number = 0;
  const char* const end = name.data() + name.size();
  if (std::from_chars(name.data(), end, number).ptr == end && number >= 1 &&
      number <= table.names.size()) {
    return number - 1;
  }
  throw WrongKey("structure.contact", fmt::format("the table has no sensor \"{}\"; it has {}", name,
                                                  fmt::join(table.names, ", ")));
}

// The real parts of the modal constants of a sensor at the contact are φ²/m.
std::vector<double> drive_of(const std::string& contact, const StructureTable& table) {
  const std::size_t k = sensor_named(contact, table);
  const SensorKind kind = table.model.sensors[k];
  if (kind == SensorKind::kForce || kind == SensorKind::kStrain) {
    throw WrongKey(
        "structure.contact",
        fmt::format("\"{}\" reads a {}: how the contact moves is told by a displacement, "
                    "a velocity or an acceleration there",
                    contact, name_of(kind)));
  }
  std::vector<double> drive;
  for (std::size_t n = 0; n < table.model.poles.size(); ++n) {
    drive.push_back(table.model.constant(k, n));
    if (drive.back() >= 0.0) continue;
    throw WrongKey(
        "structure.contact",
        fmt::format(
            "the modal constant of \"{}\" at {:.6g} Hz is {:.3g}: negative, which no sensor "
            "reads where the force acts; state the sensor there, or in the table contact: "
            "with phi^2/m of every mode, 0 for one that does not move there",
            contact, table.frequency(n), drive.back()));
  }
  return drive;
}

}  // namespace

void StructureSceneOptions::visit(OptionVisitor& visitor) {
  visitor("table", "file of the modes, as fit_modes writes it; relative to the experiment's folder",
          {.required = true}, table);
  visitor("contact",
          "sensor of the table, by name or by number from 1, that reads where the force acts and "
          "in its direction; empty: the table tells by its own contact or by its shapes",
          contact);
  StructureBow stroke{bow};
  visitor("bow", "what slides on the structure and presses", stroke);
  visitor("friction", "friction between bow and structure", friction);
  visitor("duration", "length of the record", {.unit = "s", .range = Range::positive()}, duration);
  visitor("rest", "of it, before the bow touches; its gestures count from there",
          {.unit = "s", .range = Range::non_negative()}, rest);
  visitor("oversampling",
          "the scene is simulated at so many sample rates and recorded through an anti-alias "
          "filter, flat to 0.4 of the sample rate; 1: at its instants, without a filter",
          {.range = Range::closed(1, 64)}, oversampling);
}

Scene StructureSceneOptions::scene(double sample_rate) const {
  Scene scene;
  scene.bow = bow;
  scene.friction = friction;
  // The filter sees what follows the last sample.
  const std::size_t reach = oversampling > 1 ? decimation_reach() : 0;
  const double samples = static_cast<double>(sample_count(duration, sample_rate) + reach);
  scene.duration = (samples - std::floor(rest * sample_rate)) / sample_rate;
  return scene;
}

std::vector<double> StructureSceneOptions::recorded(const std::vector<double>& fine,
                                                    double sample_rate) const {
  const auto step = static_cast<std::size_t>(oversampling);
  std::vector<double> all(step * static_cast<std::size_t>(std::floor(rest * sample_rate)), 0.0);
  all.insert(all.end(), fine.begin(), fine.end());
  // Where a signal jumps, its Fourier series is halfway.
  if (fine.size() < all.size() && step > 1) all[all.size() - fine.size()] *= 0.5;
  std::vector<double> kept = decimated(all, step);
  kept.resize(sample_count(duration, sample_rate));
  return kept;
}

DrivenStructure StructureSceneOptions::driven(const StructureTable& told) const {
  told.require_modes("a simulation");
  if (!contact.empty()) return {simulated_part(told.model), drive_of(contact, told)};
  if (told.contact.empty()) {
    throw WrongKey("structure.table",
                   fmt::format("{} does not tell how the contact moves, which responses elsewhere "
                               "do not: name the sensor that reads there (structure.contact), or "
                               "state in the table contact: with phi^2/m of every mode",
                               table));
  }
  return {simulated_part(told.model), told.contact};
}

FileRead StructureSceneOptions::file_read(double sample_rate) const {
  // Of a table of three sensors; each further one is another number a step.
  constexpr double kNumbersPerStep = 10.0;
  return {.name = table,
          .key = "structure.table",
          .numbers = kNumbersPerStep * duration * fine_rate(sample_rate),
          .named = files_named_by_table};
}

std::vector<Finding> StructureSceneOptions::lint(const Choice<Simulator>& simulator,
                                                 const Measurement& measurement) const {
  std::vector<Finding> findings;
  lint_bow("structure.bow", bow, duration, findings);
  const std::size_t before = findings.size();
  lint_making(findings, "structure.friction", [&] { friction.make(); });
  lint_making(findings, "simulator", [&] { simulator.make(); });
  if (findings.size() == before) {
    Scene any;
    any.friction = friction;
    for (const SceneRefusal& refusal : simulator.make()->refusals(any)) {
      add_finding(findings, "structure." + refusal.key, "{}", refusal.reason);
    }
  }
  lint_making(findings, "structure.duration",
              [&] { sample_count(duration, fine_rate(measurement.sample_rate)); });
  if (!(rest < duration)) {
    add_finding(findings, "structure.rest", "{:g} s of rest leave nothing of a record of {:g} s",
                rest, duration);
  }
  if (measurement.remove_mean) {
    findings.push_back({"measurement",
                        "identify_force takes a record that begins at rest, and the mean that is "
                        "removed shifts that: state remove_mean: false to identify this force",
                        false});
  }
  return findings;
}

std::vector<Finding> StructureSceneOptions::lint_table(const std::filesystem::path& folder,
                                                       const Choice<Simulator>& simulator,
                                                       const Measurement& measurement) const {
  std::vector<Finding> findings;
  std::optional<StructureTable> told;
  lint_making(findings, "structure.table", [&] { told = read_table(folder / table); });
  if (!told) return findings;
  const double half = 0.5 * measurement.sample_rate;
  for (std::size_t n = 0; n < told->model.poles.size(); ++n) {
    if (told->frequency(n) < half) continue;
    add_finding(findings, "measurement.sample_rate",
                "the mode at {:.6g} Hz is not below half the sample rate, {:.6g} Hz: use a higher "
                "rate, or a table without it",
                told->frequency(n), half);
    break;
  }
  // Two steps tell whether they are short enough.
  lint_making(findings, "simulator", [&] {
    const DrivenStructure structure = driven(*told);
    const auto made = simulator.make();
    Scene begin = scene(measurement.sample_rate);
    const double step = made->longest_step(), fine = fine_rate(measurement.sample_rate);
    const double rate = std::isfinite(step) ? 1.0 / plan_steps(step, fine).time_step : fine;
    begin.duration = 2.0 / rate;
    simulate_structure(*made, begin, structure, rate);
  });
  return findings;
}

}  // namespace modcal
