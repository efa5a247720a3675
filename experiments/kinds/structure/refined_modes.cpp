#include "experiments/kinds/structure/refined_modes.hpp"

#include <fmt/ranges.h>

#include <cmath>
#include <numeric>

#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

constexpr Index frequency_of(std::size_t n) { return static_cast<Index>(2 * n); }
constexpr Index damping_of(std::size_t n) { return frequency_of(n) + 1; }

// Mean square of what should be N(0, 1) numbers beyond what as many of them reach once in a
// million: 1 + 5 √(2/n), a χ² of n degrees of freedom by its standard deviation.
struct Surprises {
  double squares = 0.0;
  double count = 0.0;
  void add(double value) {
    if (std::isnan(value)) return;
    squares += value * value;
    count += 1.0;
  }
  bool contradict() const {
    return count > 0.0 && squares / count > 1.0 + 5.0 * std::sqrt(2.0 / count);
  }
  std::string text(std::string_view of, std::string_view key) const {
    return fmt::format(
        "the responses contradict the change that was allowed for: {} are {:.1f} times as far from "
        "the table as change.{} says (rms); the answer leans on that: state more",
        of, std::sqrt(squares / count), key);
  }
};

}  // namespace

StructureTable RefinedModes::after() const {
  StructureTable result = table;
  result.model = fit.model;
  result.frequency_deviations.resize(modes());
  result.damping_deviations.resize(modes());
  for (std::size_t n = 0; n < modes(); ++n) {
    const Index f = frequency_of(n), zeta = damping_of(n);
    result.frequency_deviations[n] = std::sqrt(fit.covariance(f, f));
    result.damping_deviations[n] = std::sqrt(fit.covariance(zeta, zeta));
  }
  return result;
}

void RefinedModes::visit(ResultVisitor& visitor) const {
  const StructureTable found = after();
  std::vector<std::size_t> all(modes());
  std::iota(all.begin(), all.end(), std::size_t{0});
  visitor.rows(
      {.key = "refined_modes",
       .table = "refined_modes",
       .name = "Modes refined without the force",
       .meaning = "The table's modes and what the responses make of them, with standard "
                  "deviations. Told is the share of it that the responses tell; the rest is the "
                  "table's, within the change that was allowed for."},
      all, [&](ResultVisitor& row, std::size_t n) {
        const double frequency = found.frequency(n), zeta = found.model.poles[n].zeta;
        row({.key = "n", .name = "mode"}, n + 1);
        row({.key = "table_f_hz", .name = "table", .unit = "Hz", .format = "{:.6g}"},
            table.frequency(n));
        row({.key = "f_hz", .name = "frequency", .unit = "Hz", .format = "{:.6g}"}, frequency);
        row({.key = "f_sd_hz", .name = "its deviation", .unit = "Hz", .format = "{:.2g}"},
            frequency * found.frequency_deviations[n]);
        row({.key = "f_told", .name = "told", .format = "{:.3f}"}, fit.told[frequency_of(n)]);
        row({.key = "table_zeta", .name = "table", .format = "{:.4g}"}, table.model.poles[n].zeta);
        row({.key = "zeta", .name = "damping ratio", .format = "{:.4g}"}, zeta);
        row({.key = "zeta_sd", .name = "its deviation", .format = "{:.2g}"},
            zeta * found.damping_deviations[n]);
        row({.key = "zeta_told", .name = "told", .format = "{:.3f}"}, fit.told[damping_of(n)]);
      });
  visitor({.key = "refined_chi2"}, known(fit.misfit));
  visitor({.key = "refined_degrees"}, fit.degrees);
}

std::string RefinedModes::sentence() const {
  std::vector<double> moved, deviations;
  for (std::size_t n = 0; n < modes(); ++n) {
    const Index f = frequency_of(n);
    moved.push_back(std::abs(fit.change[f]));
    deviations.push_back(std::sqrt(fit.covariance(f, f)));
  }
  const std::string left =
      std::isnan(fit.misfit)
          ? std::string("the responses are worth no more numbers than there are unknowns")
          : fmt::format("{:.0f} of the {:.0f} numbers that the responses are worth are left",
                        fit.degrees, fit.numbers);
  return fmt::format(
      "modes refined without the force: median change of a frequency {:.2g}, its deviation "
      "{:.2g}; {}\n",
      quantile(moved, 0.5), quantile(deviations, 0.5), left);
}

void RefinedModes::add_parameters(std::vector<FoundParameter>& parameters) const {
  const StructureTable found = after();
  for (std::size_t n = 0; n < modes(); ++n) {
    const double frequency = found.frequency(n), zeta = found.model.poles[n].zeta;
    parameters.push_back({fmt::format("f_{}", n + 1), frequency,
                          frequency * found.frequency_deviations[n], "Hz", table.frequency(n)});
    parameters.push_back({fmt::format("zeta_{}", n + 1), zeta, zeta * found.damping_deviations[n],
                          "1", table.model.poles[n].zeta});
  }
}

std::vector<std::string> RefinedModes::doubts() const {
  Surprises frequencies, dampings, constants;
  std::vector<std::string> untold;
  for (std::size_t n = 0; n < modes(); ++n) {
    frequencies.add(fit.surprise(frequency_of(n)));
    dampings.add(fit.surprise(damping_of(n)));
    if (fit.told[frequency_of(n)] > 0.5) continue;
    untold.push_back(fmt::format("{:.4g}", table.frequency(n)));
  }
  for (Index i = frequency_of(modes()); i < fit.change.size(); ++i) constants.add(fit.surprise(i));
  std::vector<std::string> texts;
  // Sizes that were found are no statement that could be contradicted.
  const bool is_stated = !fit.allowed.is_found;
  if (!is_stated) {
    texts.push_back(fmt::format(
        "the sensors contradict the table as it is: a structure was allowed for that has changed "
        "by as much as they tell, {:.2g} % in frequencies, {:.2g} % in damping ratios, {:.2g} % in "
        "modal constants; unchanged: true takes the table as it is",
        100.0 * fit.allowed.frequency, 100.0 * fit.allowed.damping, 100.0 * fit.allowed.residue));
  }
  if (is_stated && frequencies.contradict())
    texts.push_back(frequencies.text("frequencies", "frequency"));
  if (is_stated && dampings.contradict())
    texts.push_back(dampings.text("damping ratios", "damping"));
  if (is_stated && constants.contradict())
    texts.push_back(constants.text("modal constants", "residue"));
  if (!untold.empty()) {
    texts.push_back(
        fmt::format("the responses do not tell the frequencies of {} of {} modes, which stay the "
                    "table's: those at {} Hz",
                    untold.size(), modes(), fmt::join(untold, ", ")));
  }
  return texts;
}

report::Figure RefinedModes::figure() const {
  report::Series frequencies{.label = "frequency", .style = report::SeriesStyle::kPoints};
  report::Series dampings{.label = "damping ratio", .style = report::SeriesStyle::kPoints};
  const auto add = [this](Index i, double at, report::Series& series) {
    const double half = 1.959964 * std::sqrt(fit.covariance(i, i));
    const double low = fit.change[i] - half, high = fit.change[i] + half;
    series.add(at, 100.0 * std::expm1(fit.change[i]), 100.0 * std::expm1(low),
               100.0 * std::expm1(high));
  };
  for (std::size_t n = 0; n < modes(); ++n) {
    add(frequency_of(n), table.frequency(n), frequencies);
    add(damping_of(n), table.frequency(n), dampings);
  }
  const report::Axis over{.label = "frequency of the table", .unit = "Hz"};
  return {.id = "refined_modes_figure",
          .title = "Modes refined without the force",
          .caption =
              "By how much frequencies and damping ratios are above those of the table, "
              "with 95 %.",
          .panels = {{.x = over,
                      .y = {.label = "frequency above the table", .unit = "%"},
                      .series = {std::move(frequencies)}},
                     {.x = over,
                      .y = {.label = "damping above the table", .unit = "%"},
                      .series = {std::move(dampings)}}}};
}

}  // namespace modcal
