// Figures that every identification shows unasked.
#include <algorithm>
#include <cmath>

#include "experiments/study/figures.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

using report::ColorRole;
using report::Figure;
using report::Panel;
using report::Series;
using report::SeriesStyle;

constexpr double kBand = 1.96;         // deviations of 95 %
constexpr double kPeriodsShown = 4.0;  // where single strokes are to be seen
constexpr std::size_t kStretches = 1000;

// Samples from `first` on, one past the last, and the scale of their time axis. Of every `stretch`
// of samples the lowest and the highest are drawn, without bands, where it is longer than 1.
struct Part {
  std::size_t first = 0, last = 0;
  double per_second = 1.0;
  const char* unit = "s";
  std::size_t stretch = 1;
};

// A signal of an estimate as it is drawn.
struct Shown {
  std::string_view quantity;  // of kQuantities
  const char* label;
  const char* unit;
  double scale;  // unit per SI unit
};
constexpr Shown kForce{"f_c", "force f_c", "N", 1.0};
constexpr Shown kDisplacement{"y", "displacement y", "µm", 1e6};
constexpr Shown kVelocity{"v", "velocity v", "mm/s", 1e3};

struct Drawing {
  const Observation& observation;
  const std::vector<SideIdentification>& sides;

  double rate() const { return observation.sample_rate; }
  std::size_t samples() const { return observation.samples(); }
  double fundamental() const { return observation.fundamental; }

  // The middle of the record, a few periods long.
  Part middle() const {
    const auto half =
        static_cast<std::size_t>(std::ceil(0.5 * kPeriodsShown * rate() / fundamental()));
    const std::size_t center = samples() / 2;
    return {center - std::min(center, half), std::min(samples(), center + half + 1), 1e3, "ms"};
  }
  Part all() const {
    return {0, samples(), 1.0, "s", std::max<std::size_t>(2, samples() / kStretches)};
  }
};

// Indices of a part's samples that are drawn.
std::vector<std::size_t> drawn_of(const Part& part, std::span<const double> samples) {
  std::vector<std::size_t> drawn;
  const std::size_t last = std::min(part.last, samples.size());
  for (std::size_t j = part.first; j < last; j += part.stretch) {
    const auto stretch = samples.subspan(j, std::min(part.stretch, last - j));
    const auto [low, high] = std::ranges::minmax_element(stretch);
    const auto a = j + static_cast<std::size_t>(low - stretch.begin());
    const auto b = j + static_cast<std::size_t>(high - stretch.begin());
    drawn.push_back(std::min(a, b));
    if (a != b) drawn.push_back(std::max(a, b));
  }
  return drawn;
}

// The true signal without its static part, which no reaction tells; empty: not known.
std::vector<double> truth_of(const Observation& observation, const Quantity& quantity) {
  std::vector<double> samples;
  if (observation.truth) {
    samples = (observation.truth->simulation.*quantity.simulated).samples;
  } else if (quantity.reference != nullptr && observation.*quantity.reference) {
    samples = (observation.*quantity.reference)->samples;
  }
  if (!samples.empty()) remove_mean(samples);
  return samples;
}

Panel signal_panel(const Drawing& drawing, const SideIdentification& side, const Shown& shown,
                   const Part& part) {
  Panel panel{.title = side.estimate.label,
              .x = {.label = "time", .unit = part.unit},
              .y = {.label = shown.label, .unit = shown.unit}};
  const Quantity& quantity = quantity_of(shown.quantity);
  std::vector<double> found = side.estimate.result.*quantity.identified;
  if (!found.empty()) remove_mean(found);
  Series identified{.label = "identified"};
  const bool banded =
      part.stretch == 1 && !std::isnan(quantity.deviation_at(side.estimate, part.first));
  if (banded) identified.label += ", 95 % band";
  const auto time = [&](std::size_t j) {
    return part.per_second * static_cast<double>(j) / drawing.rate();
  };
  for (const std::size_t j : drawn_of(part, found)) {
    const double value = shown.scale * found[j];
    if (!banded) {
      identified.add(time(j), value);
      continue;
    }
    const double width = kBand * shown.scale * quantity.deviation_at(side.estimate, j);
    identified.add(time(j), value, value - width, value + width);
  }
  panel.series.push_back(std::move(identified));
  const std::vector<double> truth = truth_of(drawing.observation, quantity);
  if (truth.empty()) return panel;
  // Along a record it is an area that would cover all else.
  const bool along = part.stretch > 1;
  Series reference{.label = drawing.observation.truth ? "true" : "measured",
                   .style = along ? SeriesStyle::kLine : SeriesStyle::kDashed,
                   .color = along ? ColorRole::kMuted : ColorRole::kReference};
  for (const std::size_t j : drawn_of(part, truth)) reference.add(time(j), shown.scale * truth[j]);
  panel.series.insert(along ? panel.series.begin() : panel.series.end(), std::move(reference));
  return panel;
}

struct Row {
  Shown shown;
  Part part;
};

// A panel of every row and side.
Figure signal_figure(const Drawing& drawing, Figure figure, std::initializer_list<Row> rows) {
  figure.columns = drawing.sides.size();
  for (const Row& row : rows) {
    for (const SideIdentification& side : drawing.sides) {
      figure.panels.push_back(signal_panel(drawing, side, row.shown, row.part));
    }
  }
  return figure;
}

std::string band_text(const Drawing& drawing) {
  const double limit = 1e-3 * drawing.sides.front().estimate.band_limit;
  if (std::isnan(limit)) return {};
  return fmt::format(" The band is that of what lies below {:.4g} kHz.", limit);
}

Figure force_figure(const Drawing& drawing) {
  Figure figure{.id = "identified_force",
                .title = "Contact force",
                .caption = fmt::format("{:g} periods from the middle, static part left out.{}",
                                       kPeriodsShown, band_text(drawing))};
  return signal_figure(drawing, std::move(figure), {{kForce, drawing.middle()}});
}

Figure force_record_figure(const Drawing& drawing) {
  Figure figure{.id = "identified_force_record",
                .title = "Contact force along the record",
                .caption =
                    "The lowest and the highest values of each stretch, static part left "
                    "out."};
  return signal_figure(drawing, std::move(figure), {{kForce, drawing.all()}});
}

Figure motion_figure(const Drawing& drawing) {
  Figure figure{.id = "identified_motion",
                .title = "Motion of the string at the contact",
                .caption = fmt::format("{:g} periods from the middle, static parts left out.{}",
                                       kPeriodsShown, band_text(drawing))};
  return signal_figure(drawing, std::move(figure),
                       {{kDisplacement, drawing.middle()}, {kVelocity, drawing.middle()}});
}

Figure friction_loop_figure(const Drawing& drawing) {
  Figure figure{.id = "identified_force_over_velocity",
                .title = "Contact force over the velocity of the string",
                .caption = fmt::format(
                    "{:g} periods from the middle of the record: a string that sticks stands at "
                    "the bow's velocity.",
                    kPeriodsShown),
                .columns = drawing.sides.size()};
  const Part part = drawing.middle();
  for (const SideIdentification& side : drawing.sides) {
    const InversionResult& found = side.estimate.result;
    Panel panel{.title = side.estimate.label,
                .x = {.label = kVelocity.label, .unit = kVelocity.unit},
                .y = {.label = kForce.label, .unit = kForce.unit}};
    Series loop{.label = "identified", .style = SeriesStyle::kPoints};
    for (std::size_t j = part.first; j < std::min(part.last, found.force.size()); ++j)
      loop.add(kVelocity.scale * found.velocity[j], found.force[j]);
    panel.series.push_back(std::move(loop));
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

// |X_k|/f_s below the highest mode's neighborhood, frequencies in kHz.
Series spectrum_of(std::span<const double> samples, double rate, double highest, Series series) {
  const RealFft fft(samples.size());
  const std::vector<Complex> spectrum = fft.forward(samples);
  for (std::size_t k = 1; k < spectrum.size(); ++k) {
    const double f = static_cast<double>(k) * rate / static_cast<double>(fft.length());
    if (f <= highest) series.add(1e-3 * f, std::abs(spectrum[k]) / rate);
  }
  return series;
}

// Standard deviation of the noise of a reaction as the estimate took it; NaN: it took none.
double noise_of(const std::vector<SideIdentification>& sides, std::size_t reaction) {
  const std::string name = fmt::format("noise_rms_{}", reaction + 1);
  for (const SideIdentification& side : sides) {
    for (const auto& [key, value] : side.estimate.figures) {
      if (key == name) return value;
    }
  }
  return std::numeric_limits<double>::quiet_NaN();
}

Figure spectra_figure(const Drawing& drawing) {
  Figure figure{.id = "reaction_spectra",
                .title = "Spectra of the reactions and of the force",
                .caption = "Dashed: the noise of the sensor."};
  const Observation& observation = drawing.observation;
  const double highest = std::min(0.5 * drawing.rate(),
                                  1.1 * observation.basis.frequency(observation.basis.size() - 1));
  const auto add = [&](std::string title, std::string label, Series series,
                       std::span<const double> samples, double limit) {
    Panel panel{.title = std::move(title),
                .x = {.label = "frequency", .unit = "kHz"},
                .y = {.label = std::move(label), .unit = "N s", .logarithmic = true}};
    panel.series.push_back(spectrum_of(samples, drawing.rate(), limit, std::move(series)));
    figure.panels.push_back(std::move(panel));
  };
  for (const End end : kEnds) {
    const auto& reaction = observation.reaction(end);
    if (!reaction) continue;
    const auto r = static_cast<std::size_t>(end);
    add(fmt::format("reaction at {}", label_of(end)), fmt::format("|R_{}|", r + 1),
        {.label = "record", .color = ColorRole::kReference}, reaction->samples, highest);
    const double noise = noise_of(drawing.sides, r);
    if (!(noise > 0.0)) continue;
    const double floor = noise * std::sqrt(static_cast<double>(reaction->size())) / drawing.rate();
    Series level{.label = "noise of the sensor",
                 .style = SeriesStyle::kDashed,
                 .color = ColorRole::kReference};
    level.add(0.0, floor);
    level.add(1e-3 * highest, floor);
    figure.panels.back().series.push_back(std::move(level));
  }
  for (const SideIdentification& side : drawing.sides) {
    // Above the limit of its band a force is rounding. Of NaN fmin takes the other.
    add("force " + side.estimate.label, "|F_c|", {.label = "identified"},
        side.estimate.result.force, std::fmin(highest, side.estimate.band_limit));
  }
  figure.columns = std::min<std::size_t>(figure.panels.size(), 2);
  return figure;
}

Figure misfit_figure(const Drawing& drawing) {
  Figure figure{.id = "reaction_misfit",
                .title = "What the two reactions contradict each other by",
                .caption =
                    "Power of R_1 H_2 − R_2 H_1, about 40 Hz smoothed, over what the noise puts "
                    "there: 1 where one force explains both reactions."};
  for (const SideIdentification& side : drawing.sides) {
    const std::vector<double>& misfit = side.estimate.side_misfit;
    if (misfit.empty()) continue;
    Panel panel{.title = side.estimate.label,
                .x = {.label = "frequency", .unit = "kHz"},
                .y = {.label = "misfit", .logarithmic = true}};
    Series series{.label = "misfit"};
    const double width = drawing.rate() / static_cast<double>(drawing.samples());
    for (std::size_t k = 1; k < misfit.size(); ++k) {
      const double f = static_cast<double>(k) * width;
      if (side.estimate.band_limit < f) break;
      series.add(1e-3 * f, misfit[k]);
    }
    panel.series.push_back(std::move(series));
    panel.markers.push_back(
        {.direction = report::Marker::Direction::kHorizontal, .value = 1.0, .label = "noise"});
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace

std::vector<Figure> overview_figures(const Observation& observation,
                                     const std::vector<SideIdentification>& sides) {
  const Drawing drawing{observation, sides};
  std::vector<Figure> figures = {force_figure(drawing),         misfit_figure(drawing),
                                 force_record_figure(drawing),  motion_figure(drawing),
                                 friction_loop_figure(drawing), spectra_figure(drawing)};
  std::erase_if(figures, [](const Figure& figure) { return figure.panels.empty(); });
  return figures;
}

}  // namespace modcal
