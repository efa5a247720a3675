// A run of `simulate` whose scene is a structure.
#include <algorithm>

#include "experiments/kinds/simulate/simulate_study.hpp"
#include "experiments/kinds/structure/structure_files.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr double kPeriods = 6.0;  // that are drawn

// The second half of the time until the bow is lifted for good [s].
struct Judged {
  double start = 0.0, end = 0.0;
  std::vector<double> of(const Signal& signal) const {
    const auto at = [&](double time) {
      const auto j = static_cast<std::size_t>(std::ceil(time * signal.sample_rate));
      return signal.samples.begin() + static_cast<std::ptrdiff_t>(std::min(j, signal.size()));
    };
    return {at(start), at(end)};
  }
};

Judged judged_part(const Scene& scene) {
  constexpr int kPlaces = 1000;
  const PiecewiseLinear force = bow_motion(scene.bow, scene.duration).normal_force;
  int last = kPlaces;
  while (last > 1 && !(force.at(scene.duration * (last - 1) / kPlaces) > 0.0)) --last;
  const double end = scene.duration * last / kPlaces;
  return {0.5 * end, end};
}

// The strongest line of a signal without its mean [Hz]; 0 where there is none.
double strongest_line(std::vector<double> samples, double rate) {
  if (samples.size() < 4) return 0.0;
  remove_mean(samples);
  const std::vector<Complex> spectrum = RealFft(samples.size()).forward(samples);
  const auto most =
      std::ranges::max_element(spectrum, {}, [](const Complex& value) { return std::norm(value); });
  return static_cast<double>(most - spectrum.begin()) * rate / static_cast<double>(samples.size());
}

std::string contact_text(const Simulation& contact, const Judged& judged, double line) {
  double held = 0.0, since = 0.0;
  bool sticks = false;
  std::size_t releases = 0;
  const auto add_held = [&](double until) {
    held += std::max(0.0, std::min(until, judged.end) - std::max(since, judged.start));
  };
  for (const Switch& change : contact.switches) {
    if (sticks && !change.attaches) {
      add_held(change.time);
      if (change.time >= judged.start && change.time <= judged.end) ++releases;
    }
    sticks = change.attaches;
    since = change.time;
  }
  if (sticks) add_held(judged.end);
  const std::vector<double> force = judged.of(contact.force);
  const auto [low, high] = std::minmax_element(force.begin(), force.end());
  const double length = judged.end - judged.start;
  const std::string does =
      held == 0.0 ? "slides all the time"
      : releases == 0
          ? "is held without a slip"
          : fmt::format("slips {:.4g} times a second and sticks for {:.0f} % of the time",
                        static_cast<double>(releases) / length, 100.0 * held / length);
  return fmt::format(
      "From {:.3g} to {:.3g} s under the bow the contact {}, its strongest line at "
      "{:.5g} Hz; friction force from {:.2g} to {:.2g} N",
      judged.start, judged.end, does, line, low == force.end() ? 0.0 : *low,
      high == force.end() ? 0.0 : *high);
}

std::string sensor_name(const StructureTable& table, std::size_t k) {
  const std::string& name = table.names[k];
  const bool taken = name.empty() || std::ranges::count(table.names, name) > 1 ||
                     std::ranges::count(kQuantities, name, &Quantity::name) > 0;
  return taken ? fmt::format("sensor_{}", k + 1) : name;
}

// What is asked for of the contact, and what the sensors measure.
std::vector<Signal> signals_of(const SimulateOptions& options, const StructureTable& table,
                               const StructureSimulation& found) {
  std::vector<Signal> signals;
  for (const Quantity& quantity : kQuantities) {
    if (quantity.identified == nullptr || std::ranges::count(options.outputs, quantity.name) == 0) {
      continue;
    }
    Signal signal = found.contact.*quantity.simulated;
    signal.sample_rate = options.measurement.sample_rate;
    signal.samples = options.structure.recorded(signal.samples, signal.sample_rate);
    signals.push_back(std::move(signal));
  }
  const StreamKey noise =
      StreamKey(static_cast<std::uint64_t>(options.seed)).with("measurement noise");
  for (std::size_t k = 0; k < found.sensors.size(); ++k) {
    const Signal read{
        sensor_name(table, k), std::string(unit_of(table.model.sensors[k])),
        options.measurement.sample_rate,
        options.structure.recorded(found.sensors[k], options.measurement.sample_rate)};
    signals.push_back(measure(read, options.measurement, noise.with("sensor").with(k)));
  }
  return signals;
}

// Until `end` [s].
report::Figure last_periods(const std::vector<Signal>& signals, double end, double line) {
  report::Figure figure{.id = "motion", .title = "The last periods under the bow"};
  for (const Signal& signal : signals) {
    const double rate = signal.sample_rate;
    const auto last = std::min(signal.size(), static_cast<std::size_t>(end * rate));
    const double shown = line > 0.0 ? kPeriods / line * rate : static_cast<double>(last);
    report::Series series;
    for (std::size_t j = last - std::min(last, static_cast<std::size_t>(shown)); j < last; ++j) {
      series.add(static_cast<double>(j) / rate, signal.samples[j]);
    }
    figure.panels.push_back({.x = {.label = "time", .unit = "s"},
                             .y = {.label = signal.quantity, .unit = signal.unit},
                             .series = {std::move(series)}});
  }
  return figure;
}

}  // namespace

StudyResult SimulateOptions::run_structure(const StudyContext& context) const {
  StructureTable table = read_table(context.folder / structure.table);
  const DrivenStructure driven = structure.driven(table);
  const Scene scene = structure.scene(measurement.sample_rate);
  StructureSimulation found = simulate_structure(*truth.simulator.make(), scene, driven,
                                                 structure.fine_rate(measurement.sample_rate),
                                                 context.stop.telling(context.progress));
  Simulation& contact = found.contact;
  MODCAL_REQUIRE(!contact.diverged_at,
                 "the simulation by {} stops at {:g} s: {}; check the values of structure.bow and "
                 "structure.friction, take a shorter simulator.time_step, or another simulator",
                 truth.simulator.selected(), *contact.diverged_at, contact.explanation);
  const std::vector<Signal> signals = signals_of(*this, table, found);
  StudyResult result;
  const Judged judged = judged_part(scene);
  const double line = strongest_line(judged.of(contact.velocity), contact.velocity.sample_rate);
  result.summary = contact_text(contact, judged, line);
  for (const Signal& signal : signals) {
    for (const Quantity& quantity : kQuantities) {
      if (quantity.name == signal.quantity) contact.*quantity.simulated = signal;
    }
  }
  if (figures.empty()) {
    result.blocks.emplace_back(last_periods(signals, structure.rest + judged.end, line));
  }
  for (const FigureOptions& figure : figures) {
    result.blocks.emplace_back(simulation_figure(figure, contact));
  }
  add_signals(signals, contact, *this, result);
  if (table.model.residuals != driven.model.residuals) {
    result.warn(
        "static terms of the table that would differentiate or integrate the force are not "
        "simulated: table.yaml of this run is what was");
  }
  table.model = driven.model;
  table.contact = driven.drive;
  result.files.emplace_back("table.yaml", table_text(table));
  return result;
}

}  // namespace modcal
