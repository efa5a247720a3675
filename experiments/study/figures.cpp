#include "experiments/study/figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

using report::ColorRole;
using report::Figure;
using report::Panel;
using report::Series;
using report::SeriesStyle;

report::Axis quantity_axis(std::string_view quantity) {
  if (quantity == "y") return {.label = "y", .unit = "m"};
  if (quantity == "v") return {.label = "v", .unit = "m/s"};
  if (quantity == "f_c") return {.label = "f_c", .unit = "N"};
  return {.label = std::string(quantity), .unit = "N"};
}

Figure empty_figure(const FigureOptions& options, std::size_t columns) {
  Figure figure;
  figure.id = options.id;
  figure.title = options.title;
  figure.columns = columns;
  return figure;
}

std::vector<TimeWindow> windows_or_all(const FigureOptions& options, double duration) {
  std::vector<TimeWindow> windows = options.windows;
  if (windows.empty()) windows.emplace_back();
  for (TimeWindow& window : windows) {
    if (std::isnan(window.stop)) window.stop = duration;
    MODCAL_REQUIRE(
        window.start < window.stop && window.start < duration,
        "figure {}: the window from {:g} s to {:g} s holds nothing of a record of {:g} s",
        options.id, window.start, window.stop, duration);
  }
  return windows;
}

Series window_series(const Trace& trace, const TimeWindow& window, double rate) {
  Series series{.label = trace.label, .style = trace.style, .color = trace.color};
  const auto first = static_cast<std::size_t>(std::ceil(window.start * rate));
  const auto last = static_cast<std::size_t>(std::floor(window.stop * rate)) + 1;
  for (std::size_t k = first; k < std::min(last, trace.samples->size()); ++k) {
    series.x.push_back(static_cast<double>(k) / rate);
    series.y.push_back((*trace.samples)[k]);
  }
  return series;
}

// Range of a waveform panel: record truncation leaves spikes at the ends of an inverted record that
// are far larger than all the rest; where the extremes lie beyond three times the central 99.6 %,
// those decide and the spikes run off the axis.
std::optional<std::array<double, 2>> central_range(const std::vector<Series>& series) {
  std::vector<double> values;
  for (const Series& s : series) values.insert(values.end(), s.y.begin(), s.y.end());
  if (values.size() < 500) return std::nullopt;
  const double low = quantile(values, 0.002);
  const double high = quantile(values, 0.998);
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  const double span = high - low;
  if (!(span > 0.0) || *greatest - *least <= 3.0 * span) return std::nullopt;
  return std::array<double, 2>{low - 0.25 * span, high + 0.25 * span};
}

Series spectrum_series(const Trace& trace, double rate, double lowest, double highest) {
  Series series{.label = trace.label, .style = trace.style, .color = trace.color};
  const RealFft fft(trace.samples->size());
  const std::vector<Complex> spectrum = fft.forward(*trace.samples);
  for (std::size_t k = 1; k < spectrum.size(); ++k) {
    const double f = static_cast<double>(k) * rate / static_cast<double>(fft.length());
    if (f < lowest || f > highest) continue;
    series.x.push_back(f);
    series.y.push_back(std::abs(spectrum[k]) / rate);
  }
  return series;
}

const Signal& simulated(const Simulation& simulation, std::string_view quantity) {
  if (quantity == "y") return simulation.displacement;
  if (quantity == "v") return simulation.velocity;
  if (quantity == "f_c") return simulation.force;
  if (quantity == "R1") return simulation.left_reaction;
  return simulation.right_reaction;
}

const std::vector<double>& identified(const InversionResult& result, std::string_view quantity) {
  if (quantity == "y") return result.displacement;
  if (quantity == "v") return result.velocity;
  return result.force;
}

std::vector<double> zero_mean(std::vector<double> samples) {
  if (!samples.empty()) remove_mean(samples);
  return samples;
}

}  // namespace

Figure waveform_figure(const FigureOptions& options, double sample_rate, double duration,
                       const std::vector<std::string>& column_labels, const TraceLookup& traces) {
  Figure figure = empty_figure(options, column_labels.size());
  bool clipped = false;
  for (const std::string& quantity : options.quantities) {
    for (const TimeWindow& window : windows_or_all(options, duration)) {
      for (std::size_t column = 0; column < column_labels.size(); ++column) {
        Panel panel;
        panel.title = column_labels[column];
        panel.x = {.label = "time", .unit = "s"};
        panel.y = quantity_axis(quantity);
        for (const Trace& trace : traces(quantity, column)) {
          panel.series.push_back(window_series(trace, window, sample_rate));
        }
        panel.y.range = central_range(panel.series);
        if (panel.y.range) clipped = true;
        figure.panels.push_back(std::move(panel));
      }
    }
  }
  if (clipped) figure.caption = "Spikes at the ends of the record (truncation) run off the axes.";
  return figure;
}

Figure spectrum_figure(const FigureOptions& options, double sample_rate, double highest_frequency,
                       const std::vector<std::string>& column_labels, const TraceLookup& traces) {
  Figure figure = empty_figure(options, column_labels.size());
  const double highest =
      std::isnan(options.highest_frequency) ? highest_frequency : options.highest_frequency;
  for (const std::string& quantity : options.quantities) {
    for (std::size_t column = 0; column < column_labels.size(); ++column) {
      Panel panel;
      panel.title = column_labels[column];
      panel.x = {.label = "frequency", .unit = "Hz"};
      panel.y = quantity_axis(quantity);
      panel.y.label = "|" + panel.y.label + "(f)|";
      panel.y.unit += " s";
      panel.y.logarithmic = true;
      for (const Trace& trace : traces(quantity, column)) {
        panel.series.push_back(
            spectrum_series(trace, sample_rate, options.lowest_frequency, highest));
      }
      figure.panels.push_back(std::move(panel));
    }
  }
  return figure;
}

Figure parameter_curve_figure(const FigureOptions& options,
                              const std::vector<SideIdentification>& sides) {
  Figure figure = empty_figure(options, sides.size());
  std::vector<Panel> criteria;
  for (const SideIdentification& side : sides) {
    const std::string& name = side.estimate.side;
    const std::string superscript = fmt::format("({})", name);
    Panel corner;
    corner.title = side.estimate.label;
    corner.x = {.label = fmt::format("||R_{} - H_{} F{}||", name, name, superscript),
                .unit = "N",
                .logarithmic = true};
    corner.y = {.label = "||dF" + superscript + "/dt||", .unit = "N/s", .logarithmic = true};
    Panel criterion;
    criterion.title = corner.title;
    criterion.x = {.label = "epsilon", .unit = "N/N", .logarithmic = true};
    criterion.y = {.label = "criterion", .unit = "1", .logarithmic = true};
    Series l_curve{.label = "all parameters"};
    Series product{.label = "criterion"};
    for (const CurvePoint& point : side.estimate.result.choice.curve) {
      l_curve.x.push_back(point.residual_norm);
      l_curve.y.push_back(point.solution_norm);
      product.x.push_back(point.parameter);
      product.y.push_back(point.criterion);
    }
    const CurvePoint& chosen = side.estimate.result.choice.point;
    const std::string label = fmt::format("chosen: {:.3g}", chosen.parameter);
    corner.series = {l_curve, Series{.label = label,
                                     .x = {chosen.residual_norm},
                                     .y = {chosen.solution_norm},
                                     .style = SeriesStyle::kPoints,
                                     .color = ColorRole::kSecond}};
    criterion.series = {product, Series{.label = label,
                                        .x = {chosen.parameter},
                                        .y = {chosen.criterion},
                                        .style = SeriesStyle::kPoints,
                                        .color = ColorRole::kSecond}};
    figure.panels.push_back(std::move(corner));
    criteria.push_back(std::move(criterion));
  }
  std::move(criteria.begin(), criteria.end(), std::back_inserter(figure.panels));
  return figure;
}

Figure simulation_figure(const FigureOptions& options, const Simulation& simulation) {
  FigureOptions layout = options;
  const bool reactions = std::all_of(options.quantities.begin(), options.quantities.end(),
                                     [](const std::string& q) { return q == "R1" || q == "R2"; });
  // Reactions stand side by side: one row a window, one column an end.
  std::vector<std::string> columns = {""};
  if (reactions) {
    columns = options.quantities;
    layout.quantities = {"reaction"};
  }
  const Signal& any = simulated(simulation, options.quantities.front());
  Figure figure = waveform_figure(layout, any.sample_rate, any.duration(), columns,
                                  [&](std::string_view quantity, std::size_t column) {
                                    const std::string& name = options.quantities[column];
                                    const Signal& signal =
                                        simulated(simulation, reactions ? name : quantity);
                                    return std::vector<Trace>{{"simulated", &signal.samples}};
                                  });
  return figure;
}

Figure identification_figure(const FigureOptions& options, const Observation& observation,
                             const std::vector<SideIdentification>& sides) {
  std::vector<std::string> columns;
  for (const SideIdentification& side : sides) {
    columns.push_back(side.estimate.label);
  }
  // The identified signals have no static part, so the true ones are shown without theirs.
  std::map<std::string, std::vector<double>, std::less<>> truth;
  for (const std::string& quantity : options.quantities) {
    if (observation.truth) {
      truth[quantity] = zero_mean(simulated(observation.truth->simulation, quantity).samples);
    } else if (quantity == "f_c" && observation.reference) {
      truth[quantity] = zero_mean(observation.reference->samples);
    }
  }
  const TraceLookup traces = [&](std::string_view quantity, std::size_t column) {
    std::vector<Trace> result = {
        {"identified", &identified(sides[column].estimate.result, quantity), SeriesStyle::kLine,
         column == 0 ? ColorRole::kFirst : ColorRole::kSecond}};
    const auto known = truth.find(quantity);
    if (known != truth.end() && !known->second.empty()) {
      result.push_back({"true", &known->second, SeriesStyle::kDotted, ColorRole::kReference});
    }
    return result;
  };
  const double rate = observation.sample_rate;
  if (options.content == "spectra") {
    const double top = 1.1 * observation.basis.frequency(observation.basis.size() - 1);
    return spectrum_figure(options, rate, top, columns, traces);
  }
  const double duration = static_cast<double>(observation.samples()) / rate;
  return waveform_figure(options, rate, duration, columns, traces);
}

}  // namespace modcal
