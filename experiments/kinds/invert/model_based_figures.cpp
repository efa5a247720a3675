// Figures of a model-based estimate.

#include "experiments/kinds/invert/invert.hpp"

namespace modcal {
namespace {

using report::ColorRole;
using report::Series;
using report::SeriesStyle;

constexpr double kBarDeviations = 1.96;  // 95 % of a normal distribution

Series cells_of(const std::vector<double>& velocity, const std::vector<double>& force,
                double bow_velocity, const char* label, ColorRole color) {
  Series series{.label = label, .style = SeriesStyle::kPoints, .color = color};
  for (const auto& cell : observer::friction_curve(velocity, force, bow_velocity, 24)) {
    series.add(cell.speed, cell.median, cell.low, cell.high);
  }
  return series;
}

Series law_curve(const observer::BlendedSliding& law, double fastest) {
  constexpr int kPoints = 100;
  Series series{.label = "fitted law", .color = ColorRole::kReference};
  for (int i = 0; i <= kPoints; ++i) {
    const double speed = fastest * i / kPoints;
    series.add(speed, law.at(speed).force);
  }
  return series;
}

// Samples of the window: first and one past the last.
std::pair<std::size_t, std::size_t> samples_in(double start, double duration, double rate,
                                               std::size_t all) {
  const auto first = static_cast<std::size_t>(std::max(0.0, start * rate));
  const auto length = static_cast<std::size_t>(duration * rate);
  return {first, std::min(all, first + length + 1)};
}

}  // namespace

report::Figure friction_figure(const Observation& observation, const ModelBasedResult& result,
                               double start, double duration) {
  const double sign = result.negated ? -1.0 : 1.0;
  const double bow = sign * result.parameters.bow_velocity;
  report::Panel curve{
      .title = "Sliding: force against slip speed",
      .x = {.label = "|v_c|", .unit = "m/s"},
      .y = {.label = "|f_c|", .unit = "N"},
      .series = {
          cells_of(result.linear.velocity, result.linear.force, bow, "linear", ColorRole::kMuted),
          cells_of(result.velocity, result.force, bow, "model-based", ColorRole::kFirst)}};
  double fastest = 0.0;
  for (const double v : result.velocity) fastest = std::max(fastest, sign * (bow - v));
  // A thermal law has no one force for a speed.
  if (!result.parameters.sliding.thermal) {
    curve.series.push_back(law_curve(result.parameters.sliding, fastest));
  }
  const auto [first, last] =
      samples_in(start, duration, observation.sample_rate, result.force.size());
  const auto loop = [&, begin = first, end = last](const char* label, const std::vector<double>& v,
                                                   const std::vector<double>& f,
                                                   const std::vector<double>& deviation,
                                                   ColorRole color) {
    Series series{.label = label, .style = SeriesStyle::kPoints, .color = color};
    for (std::size_t k = begin; k < end; ++k) {
      series.add(v[k] - bow, f[k], f[k] - kBarDeviations * deviation[k],
                 f[k] + kBarDeviations * deviation[k]);
    }
    return series;
  };
  report::Panel loops{.title = "Loops",
                      .x = {.label = "v_c", .unit = "m/s"},
                      .y = {.label = "f_c", .unit = "N"},
                      .series = {loop("linear", result.linear.velocity, result.linear.force,
                                      result.linear.force_deviation, ColorRole::kMuted),
                                 loop("model-based", result.velocity, result.force,
                                      result.deviation.force, ColorRole::kFirst)}};
  return {
      .id = "friction_law",
      .title = "Friction law",
      .caption =
          "Left: medians of cells of slip speed with the 5 and 95 % quantiles of their samples. "
          "Right: the bars are 95 % bands under the sensors' noise and, for the model-based "
          "estimate, its model error; what the band limit of the linear one cuts off is not "
          "counted. The linear estimate assumes no law; the model-based one "
          "lies on its own.",
      .columns = 2,
      .panels = {std::move(curve), std::move(loops)}};
}

report::Figure model_force_figure(const Observation& observation, const ModelBasedResult& result,
                                  double start, double duration) {
  const double rate = observation.sample_rate;
  const auto [first, last] = samples_in(start, duration, rate, result.force.size());
  const auto curve = [rate, begin = first, end = last](const char* label,
                                                       const std::vector<double>& samples,
                                                       SeriesStyle style, ColorRole color) {
    Series series{.label = label, .style = style, .color = color};
    for (std::size_t k = begin; k < end; ++k) {
      series.add(static_cast<double>(k) / rate, samples[k]);
    }
    return series;
  };
  report::Panel panel{
      .title = "Friction force",
      .x = {.label = "t", .unit = "s"},
      .y = {.label = "f_c", .unit = "N"},
      .series = {curve("linear", result.linear.force, SeriesStyle::kLine, ColorRole::kMuted),
                 curve("model-based", result.force, SeriesStyle::kLine, ColorRole::kFirst)}};
  if (observation.reference) {
    panel.series.push_back(curve("truth", observation.reference->samples, SeriesStyle::kDashed,
                                 ColorRole::kReference));
  }
  return {.id = "model_based_force",
          .title = "Contact force, model-based and linear",
          .caption =
              "The model-based estimate assumes a friction law of the exponential family; "
              "the linear one assumes none.",
          .panels = {std::move(panel)}};
}

}  // namespace modcal
