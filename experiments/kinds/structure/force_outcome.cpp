#include "experiments/kinds/structure/force_outcome.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

using report::Series;

struct Shape {
  ForceShape shape;
  std::string_view name;
};
constexpr std::array kShapes = {Shape{ForceShape::kAuto, "auto"},
                                Shape{ForceShape::kImpacts, "impacts"},
                                Shape{ForceShape::kSmooth, "smooth"}};

}  // namespace

std::string_view name_of(ForceShape shape) {
  return std::ranges::find(kShapes, shape, &Shape::shape)->name;
}

ForceShape force_shape_of(std::string_view name) {
  return std::ranges::find(kShapes, name, &Shape::name)->shape;
}

namespace {

double share_in_band(const std::vector<double>& error, const std::vector<double>& deviation) {
  double inside = 0.0;
  for (std::size_t j = 0; j < error.size(); ++j) {
    inside += std::abs(error[j]) <= 1.959964 * deviation[j] ? 1.0 : 0.0;
  }
  return inside / static_cast<double>(error.size());
}

}  // namespace

ForceScore score_of(const StructureForce& found, const std::vector<double>& measured, double rate,
                    const StructureTable& table) {
  const std::size_t count = found.force.size();
  std::vector<double> error(count),
      reference(measured.begin(), measured.begin() + static_cast<std::ptrdiff_t>(count));
  double ff = 0.0, rr = 0.0, fr = 0.0, ee = 0.0;
  for (std::size_t j = 0; j < count; ++j) {
    error[j] = found.force[j] - reference[j];
    ff += found.force[j] * found.force[j];
    rr += reference[j] * reference[j];
    fr += found.force[j] * reference[j];
    ee += error[j] * error[j];
  }
  const RealFft fft(count);
  const std::vector<Complex> bins = fft.forward(reference);
  std::vector<Complex> error_bins = fft.forward(error);
  double error_power = 0.0, power = 0.0;
  for (std::size_t k = 0; k < bins.size(); ++k) {
    const double at = static_cast<double>(k) * rate / static_cast<double>(count);
    if (at < table.low) error_bins[k] = 0.0;
    if (at < table.low || at > table.high) continue;
    error_power += std::norm(error_bins[k]);
    power += std::norm(bins[k]);
  }
  return {.correlation = fr / std::sqrt(ff * rr),
          .relative_error = std::sqrt(ee / rr),
          .in_band = std::sqrt(error_power / power),
          .coverage = share_in_band(error, found.deviation),
          .coverage_above = share_in_band(fft.inverse(error_bins), found.deviation)};
}

namespace {

void visit_sensors(const LoadedStructureRecord& loaded, const StructureForce& found,
                   ResultVisitor& visitor) {
  visitor.rows(
      {.key = "sensors",
       .table = "sensors",
       .name = "Sensors",
       .meaning =
           "rms of what the common force leaves of each response, over what the table's scatter "
           "and noise expect, and over the response itself; how far a prediction from the other "
           "sensors alone is off, and what of its bins lies in 95 %; the mean square of what the "
           "others leave without it, over what is expected: about 1, far less where it alone "
           "contradicts them."},
      found.sensor_misfit, [&](ResultVisitor& row, const double& misfit) {
        const auto k = static_cast<std::size_t>(&misfit - found.sensor_misfit.data());
        row({.key = "channel"}, loaded.names[k]);
        row({.key = "misfit", .name = "left, as expected: 1", .format = "{:.2f}"}, misfit);
        row({.key = "left", .name = "left of the response", .format = "{:.2g}"},
            found.sensor_left[k]);
        row({.key = "predicted_error", .name = "off from the others", .format = "{:.2g}"},
            found.predicted[k].error);
        row({.key = "predicted_coverage", .name = "in 95 %", .format = "{:.3f}"},
            found.predicted[k].coverage);
        row({.key = "others", .name = "left by the others", .format = "{:.2g}"},
            known(found.predicted[k].others));
      });
}

}  // namespace

void ForceOutcome::visit(ResultVisitor& visitor) const {
  const double rate = loaded.record.sample_rate;
  const StructureForce& first = forces.front().found;
  visitor.rows(
      {.key = "force",
       .table = "identified_force",
       .name = "Identified force",
       .meaning = forces.front().score
                      ? "The last number leaves out what the error has below the table's band: no "
                        "response tells that of the force, and a hammer's amplifier drifts."
                      : ""},
      forces, [&](ResultVisitor& row, const ContactForce& contact) {
        const StructureForce& found = contact.found;
        const std::optional<ForceScore>& score = contact.score;
        double impulse = 0.0, peak = 0.0, squares = 0.0;
        for (std::size_t j = 0; j < found.force.size(); ++j) {
          impulse += found.force[j] / rate;
          if (std::abs(found.force[j]) > std::abs(peak)) peak = found.force[j];
          squares += found.deviation[j] * found.deviation[j];
        }
        row({.key = "table"}, contact.table);
        row({.key = "shape"}, name_of(found.shape));
        row({.key = "untried_instants", .name = "instants not tried"},
            found.untried > 0.0 ? std::optional(found.untried) : std::nullopt);
        row({.key = "peak_n", .name = "peak", .unit = "N"}, peak);
        row({.key = "impulse_ns", .name = "impulse", .unit = "N s"}, impulse);
        row({.key = "deviation_n", .name = "rms deviation", .unit = "N", .format = "{:.2g}"},
            std::sqrt(squares / static_cast<double>(found.force.size())));
        row({.key = "correlation", .name = "R", .format = "{:.4f}"},
            score ? std::optional(score->correlation) : std::nullopt);
        row({.key = "relative_error", .name = "relative rms error", .format = "{:.3f}"},
            score ? std::optional(score->relative_error) : std::nullopt);
        row({.key = "relative_error_in_band", .name = "in the band", .format = "{:.3f}"},
            score ? std::optional(score->in_band) : std::nullopt);
        row({.key = "coverage", .name = "in the 95 % band", .format = "{:.3f}"},
            score ? std::optional(score->coverage) : std::nullopt);
        row({.key = "coverage_above", .name = "above the lowest frequency", .format = "{:.3f}"},
            score ? std::optional(score->coverage_above) : std::nullopt);
      });
  visit_sensors(loaded, first, visitor);
  visitor({.key = "contour_per_s"}, first.sigma);
  visitor({.key = "window_s"}, first.window);
  visitor({.key = "weak_until_s"},
          first.weak_until > 0.0 ? std::optional(first.weak_until) : std::nullopt);
  visitor({.key = "rang_before"}, first.rang);
  visitor({.key = "left_out"}, left_out.empty() ? std::nullopt : std::optional(left_out));
  visitor({.key = "background"}, first.background);
  visitor({.key = "evidence_impacts"}, known(first.evidence_impacts));
  visitor({.key = "evidence_smooth"}, known(first.evidence_smooth));
  visitor({.key = "rise", .name = "rise of the power towards 0 Hz", .format = "{:.2g}"},
          known(first.rise));
  visitor({.key = "push_odds", .name = "ln of the odds of a push over blows", .format = "{:.2g}"},
          known(first.push_odds));
  visitor({.key = "misfit"}, known(first.misfit));
  if (refined) refined->visit(visitor);
}

void PlacesOutcome::visit(ResultVisitor& visitor) const {
  const std::vector<std::size_t> set = where.credible(0.95);
  visitor.rows(
      {.key = "places",
       .table = "places",
       .name = "Places of the contact",
       .meaning = "How likely the force acts at each, all being equally likely before. "
                  "The set holds 95 % of the probability."},
      tables, [&](ResultVisitor& row, const std::string& table) {
        const auto i = static_cast<std::size_t>(&table - tables.data());
        row({.key = "table"}, table);
        row({.key = "probability", .format = "{:.3g}"}, where.probability[i]);
        row({.key = "in_set", .name = "in the 95 % set"}, std::ranges::find(set, i) != set.end());
        row({.key = "left", .name = "left of the responses", .format = "{:.3g}"}, where.left[i]);
      });
}

std::string PlacesOutcome::sentence() const {
  std::vector<std::string> named;
  for (const std::size_t i : where.credible(0.95)) named.push_back(tables[i]);
  return fmt::format("the force acts at the place of {} (probability {:.3g}); 95 % set: {}\n",
                     tables[where.best], where.probability[where.best], fmt::join(named, ", "));
}

report::Figure force_figure(const LoadedStructureRecord& loaded,
                            const std::vector<ContactForce>& forces) {
  const double rate = loaded.record.sample_rate;
  report::Figure figure{.id = "force",
                        .title = "Force at the contact",
                        .caption = "Identified from the responses, with its 95 % band."};
  if (forces.size() > 1) figure.title = "Forces at the contacts";
  for (const ContactForce& contact : forces) {
    const StructureForce& found = contact.found;
    Series identified{.label = "identified"};
    Series measured{.label = "measured", .color = report::ColorRole::kReference};
    for (std::size_t j = 0; j < found.force.size(); ++j) {
      const double at = static_cast<double>(j) / rate, half = 1.959964 * found.deviation[j];
      identified.add(at, found.force[j], found.force[j] - half, found.force[j] + half);
      if (contact.score) measured.add(at, loaded.record.force[j]);
    }
    report::Panel panel{.x = {.label = "time", .unit = "s"}, .y = {.label = "force", .unit = "N"}};
    if (forces.size() > 1) panel.title = contact.table;
    if (!measured.x.empty()) panel.series.push_back(std::move(measured));
    panel.series.push_back(std::move(identified));
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

std::size_t told_peak(const StructureForce& found) {
  const bool is_smooth = found.shape == ForceShape::kSmooth;
  const double most =
      is_smooth ? 3.0 * quantile(found.deviation, 0.5) : std::numeric_limits<double>::infinity();
  std::size_t peak = 0;
  double largest = -1.0;
  for (std::size_t j = 0; j < found.force.size(); ++j) {
    if (!(std::abs(found.force[j]) > largest) || found.deviation[j] > most) continue;
    largest = std::abs(found.force[j]);
    peak = j;
  }
  return peak;
}

}  // namespace modcal
