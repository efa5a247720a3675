#include "experiments/study/figures.hpp"

#include "libsim/base/words.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

void TimeWindow::visit(OptionVisitor& visitor) {
  visitor("start", "first instant", {.unit = "s", .range = Range::non_negative()}, start);
  visitor("stop", "last instant", {.unit = "s", .range = Range::positive(), .word = "end"}, stop);
}

void FigureOptions::visit(OptionVisitor& visitor) {
  visitor("id", "name of the figure's files", {.required = true}, id);
  visitor("title", "title; empty: that of the experiment", title);
  visitor("content", "what is drawn", {.choices = choices_of(kFigureContents)}, content);
  visitor("quantities", "rows of waveforms and spectra", {.choices = {"y", "v", "f_c", "R1", "R2"}},
          quantities);
  visitor("windows", "parts of the record; none: all of it", windows);
  visitor("modes", "number of modes whose objective is drawn", {.range = Range::closed(1, 5000)},
          modes);
  visitor("lowest_frequency", "left end of a spectrum",
          {.unit = "Hz", .range = Range::non_negative()}, lowest_frequency);
  visitor("highest_frequency", "right end of a spectrum; top_mode: 1.1 times the highest mode",
          {.unit = "Hz", .range = Range::positive(), .word = "top_mode"}, highest_frequency);
}

FigureContent FigureOptions::drawn() const {
  return enum_of<FigureContent>(kFigureContents, "content of a figure", content);
}

const Quantity& quantity_of(std::string_view name) {
  const auto* const found =
      std::find_if(std::begin(kQuantities), std::end(kQuantities),
                   [name](const Quantity& quantity) { return quantity.name == name; });
  MODCAL_REQUIRE(found != std::end(kQuantities), "no signal has the name \"{}\"", name);
  return *found;
}

OutputRequest request_of(const std::vector<std::string>& names) {
  OutputRequest request;
  for (const std::string& name : names) request.*quantity_of(name).wanted = true;
  return request;
}

namespace {

using report::ColorRole;
using report::Figure;
using report::Panel;
using report::Series;
using report::SeriesStyle;

// One curve of a panel.
struct Trace {
  std::string label;
  const std::vector<double>* samples = nullptr;
  SeriesStyle style = SeriesStyle::kLine;
  ColorRole color = ColorRole::kFirst;
};

// What stands in the panel of one quantity and one column.
using TraceLookup =
    std::function<std::vector<Trace>(const std::string& quantity, std::size_t column)>;

struct Layout {
  const FigureOptions& options;
  std::vector<std::string> columns;  // their labels
  double sample_rate = 0.0;
  double duration = 0.0;
  bool reactions = false;  // side by side: one row for both, one column an end

  Figure empty() const {
    return {.id = options.id, .title = options.title, .columns = columns.size()};
  }
  report::Axis axis_of(const std::string& quantity) const {
    return {.label = reactions ? "reaction" : quantity,
            .unit = std::string(quantity_of(quantity).unit)};
  }
};

}  // namespace

void require_inside(const std::string& id, const TimeWindow& window, double duration) {
  const double stop = std::isnan(window.stop) ? duration : window.stop;
  MODCAL_REQUIRE(window.start < stop && window.start < duration,
                 "figure {}: the window from {:g} s to {:g} s holds nothing of a record of {:g} s",
                 id, window.start, stop, duration);
}

std::vector<TimeWindow> windows_or_all(const FigureOptions& options, double duration) {
  std::vector<TimeWindow> windows = options.windows;
  if (windows.empty()) windows.emplace_back();
  for (TimeWindow& window : windows) {
    require_inside(options.id, window, duration);
    if (std::isnan(window.stop)) window.stop = duration;
  }
  return windows;
}

namespace {

Series window_series(const Trace& trace, const TimeWindow& window, double rate) {
  Series series{.label = trace.label, .style = trace.style, .color = trace.color};
  const auto end = static_cast<double>(trace.samples->size());
  const auto first = static_cast<std::size_t>(std::min(end, std::ceil(window.start * rate)));
  const auto last = static_cast<std::size_t>(std::min(end, std::floor(window.stop * rate) + 1.0));
  for (std::size_t k = first; k < last; ++k) {
    series.add(static_cast<double>(k) / rate, (*trace.samples)[k]);
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
    if (f >= lowest && f <= highest) series.add(f, std::abs(spectrum[k]) / rate);
  }
  return series;
}

Figure waveform_figure(const Layout& layout, const TraceLookup& traces) {
  Figure figure = layout.empty();
  for (const std::string& quantity : layout.options.quantities) {
    for (const TimeWindow& window : windows_or_all(layout.options, layout.duration)) {
      for (std::size_t column = 0; column < layout.columns.size(); ++column) {
        Panel panel{.title = layout.columns[column],
                    .x = {.label = "time", .unit = "s"},
                    .y = layout.axis_of(quantity)};
        for (const Trace& trace : traces(quantity, column)) {
          panel.series.push_back(window_series(trace, window, layout.sample_rate));
        }
        panel.y.range = central_range(panel.series);
        if (panel.y.range) {
          figure.caption = "Spikes at the ends of the record (truncation) run off the axes.";
        }
        figure.panels.push_back(std::move(panel));
      }
    }
  }
  return figure;
}

Figure spectrum_figure(const Layout& layout, double highest, const TraceLookup& traces) {
  Figure figure = layout.empty();
  if (!std::isnan(layout.options.highest_frequency)) highest = layout.options.highest_frequency;
  for (const std::string& quantity : layout.options.quantities) {
    for (std::size_t column = 0; column < layout.columns.size(); ++column) {
      const report::Axis axis = layout.axis_of(quantity);
      Panel panel{
          .title = layout.columns[column],
          .x = {.label = "frequency", .unit = "Hz"},
          .y = {.label = "|" + axis.label + "(f)|", .unit = axis.unit + " s", .logarithmic = true}};
      for (const Trace& trace : traces(quantity, column)) {
        panel.series.push_back(
            spectrum_series(trace, layout.sample_rate, layout.options.lowest_frequency, highest));
      }
      figure.panels.push_back(std::move(panel));
    }
  }
  return figure;
}

// A curve over the parameter and the point that was chosen on it.
std::vector<Series> curve_with_choice(const ChosenParameter& choice, double CurvePoint::*x,
                                      double CurvePoint::*y) {
  Series curve{.label = "all parameters"};
  for (const CurvePoint& point : choice.curve) curve.add(point.*x, point.*y);
  Series chosen{.label = "chosen", .style = SeriesStyle::kPoints, .color = ColorRole::kSecond};
  chosen.add(choice.point.*x, choice.point.*y);
  return {std::move(curve), std::move(chosen)};
}

Figure parameter_curve_figure(const Layout& layout, const std::vector<SideIdentification>& sides) {
  Figure figure = layout.empty();
  figure.caption =
      "Above: roughness of the force over the misfit of its reaction, one point a parameter. "
      "Below: "
      "the criterion whose minimum chooses the parameter. Square: the parameter chosen.";
  for (const SideIdentification& side : sides) {
    const auto& [label, name] = std::pair(side.estimate.label, side.estimate.side);
    figure.panels.push_back(
        {.title = label,
         .x = {.label = fmt::format("‖R_{0} − H_{0} F_{0}‖", name),
               .unit = "N",
               .logarithmic = true},
         .y = {.label = fmt::format("‖d F_{}/dt‖", name), .unit = "N/s", .logarithmic = true},
         .series = curve_with_choice(side.estimate.result.choice, &CurvePoint::residual_norm,
                                     &CurvePoint::solution_norm)});
  }
  for (const SideIdentification& side : sides) {
    figure.panels.push_back(
        {.title = fmt::format("{}: ε = {:.3g} chosen", side.estimate.label,
                              side.estimate.result.choice.point.parameter),
         .x = {.label = "ε", .unit = "N/N", .logarithmic = true},
         .y = {.label = "criterion", .unit = "1", .logarithmic = true},
         .series = curve_with_choice(side.estimate.result.choice, &CurvePoint::parameter,
                                     &CurvePoint::criterion)});
  }
  return figure;
}

std::vector<double> zero_mean(std::vector<double> samples) {
  if (!samples.empty()) remove_mean(samples);
  return samples;
}

}  // namespace

Figure simulation_figure(const FigureOptions& options, const Simulation& simulation) {
  FigureOptions rows = options;
  const bool reactions = std::ranges::all_of(options.quantities, [](const std::string& name) {
    return quantity_of(name).identified == nullptr;
  });
  if (reactions) rows.quantities.resize(1);
  const auto simulated = [&simulation](const std::string& name) -> const Signal& {
    return simulation.*quantity_of(name).simulated;
  };
  const Signal& any = simulated(options.quantities.front());
  return waveform_figure({.options = rows,
                          .columns = reactions ? options.quantities : std::vector<std::string>{""},
                          .sample_rate = any.sample_rate,
                          .duration = any.duration(),
                          .reactions = reactions},
                         [&](const std::string& quantity, std::size_t column) {
                           const std::string& name =
                               reactions ? options.quantities[column] : quantity;
                           return std::vector<Trace>{{"", &simulated(name).samples}};
                         });
}

Figure identification_figure(const FigureOptions& options, const Observation& observation,
                             const std::vector<SideIdentification>& sides) {
  const double rate = observation.sample_rate;
  Layout layout{.options = options,
                .sample_rate = rate,
                .duration = static_cast<double>(observation.samples()) / rate};
  for (const SideIdentification& side : sides) layout.columns.push_back(side.estimate.label);
  const FigureContent content = options.drawn();
  if (content == FigureContent::kParameterCurves) return parameter_curve_figure(layout, sides);
  // The identified signals have no static part, so the true ones are shown without theirs.
  std::map<std::string, std::vector<double>> truth;
  for (const std::string& name : options.quantities) {
    MODCAL_REQUIRE(quantity_of(name).identified != nullptr,
                   "figure {} draws {}, which is measured, not identified: use y, v or f_c",
                   options.id, name);
    if (observation.truth) {
      truth[name] = zero_mean((observation.truth->simulation.*quantity_of(name).simulated).samples);
    } else if (const auto& measured = observation.*quantity_of(name).reference) {
      truth[name] = zero_mean(measured->samples);
    }
  }
  const TraceLookup traces = [&](const std::string& name, std::size_t column) {
    std::vector<Trace> result = {
        {"identified", &(sides[column].estimate.result.*quantity_of(name).identified)}};
    const auto known_truth = truth.find(name);
    if (known_truth != truth.end() && !known_truth->second.empty()) {
      result.push_back({"true", &known_truth->second, SeriesStyle::kDashed, ColorRole::kReference});
    }
    return result;
  };
  if (content != FigureContent::kSpectra) return waveform_figure(layout, traces);
  const double top = 1.1 * observation.basis.frequency(observation.basis.size() - 1);
  return spectrum_figure(layout, top, traces);
}

}  // namespace modcal
