// Figures of a model-based estimate.
#include <algorithm>

#include "experiments/kinds/invert/model_based_output.hpp"
#include "libinverse/observer/friction_curve.hpp"

namespace modcal {
namespace {

constexpr double kBand = 1.96;  // 95 % of a normal distribution

report::Series cells_of(const std::vector<double>& velocity, const std::vector<double>& force,
                        double bow_velocity, const char* label, report::ColorRole color) {
  report::Series series{.label = label, .style = report::SeriesStyle::kPoints, .color = color};
  for (const auto& cell : observer::friction_curve(velocity, force, bow_velocity, 24)) {
    series.x.push_back(cell.speed);
    series.y.push_back(cell.median);
    series.y_low.push_back(cell.low);
    series.y_high.push_back(cell.high);
  }
  return series;
}

report::Series law_curve(const observer::BlendedSliding& law, double fastest) {
  constexpr int kPoints = 100;
  report::Series series{.label = "fitted law", .color = report::ColorRole::kReference};
  for (int i = 0; i <= kPoints; ++i) {
    series.x.push_back(fastest * i / kPoints);
    series.y.push_back(law.at(series.x.back()).force);
  }
  return series;
}

}  // namespace

report::Figure friction_figure(const Observation& observation,
                               const ModelIdentification& identification, double start,
                               double duration, const std::string& command) {
  const ModelBasedResult& r = identification.result;
  const double sign = r.negated ? -1.0 : 1.0;
  const double bow = sign * r.parameters.bow_velocity;
  report::Panel curve{.title = "Sliding: force against slip speed",
                      .x = {.label = "|v_c|", .unit = "m/s"},
                      .y = {.label = "|f_c|", .unit = "N"}};
  curve.series.push_back(
      cells_of(r.linear_velocity, r.linear_force, bow, "linear", report::ColorRole::kMuted));
  curve.series.push_back(
      cells_of(r.velocity, r.force, bow, "model-based", report::ColorRole::kFirst));
  double fastest = 0.0;
  for (const double v : r.velocity) fastest = std::max(fastest, sign * (bow - v));
  // A thermal law has no one force for a speed.
  if (!r.parameters.sliding.thermal) {
    curve.series.push_back(law_curve(r.parameters.sliding, fastest));
  }

  report::Panel loop{
      .title = "Loops", .x = {.label = "v_c", .unit = "m/s"}, .y = {.label = "f_c", .unit = "N"}};
  const auto first = static_cast<std::size_t>(std::max(0.0, start * observation.sample_rate));
  const std::size_t last = std::min(
      r.force.size(), first + static_cast<std::size_t>(duration * observation.sample_rate) + 1);
  const auto add = [&](const char* label, const std::vector<double>& v,
                       const std::vector<double>& f, const std::vector<double>& deviation,
                       report::ColorRole color) {
    report::Series series{.label = label, .style = report::SeriesStyle::kPoints, .color = color};
    for (std::size_t k = first; k < last; ++k) {
      series.x.push_back(v[k] - bow);
      series.y.push_back(f[k]);
      series.y_low.push_back(f[k] - kBand * deviation[k]);
      series.y_high.push_back(f[k] + kBand * deviation[k]);
    }
    loop.series.push_back(std::move(series));
  };
  add("linear", r.linear_velocity, r.linear_force, r.linear_deviation, report::ColorRole::kMuted);
  add("model-based", r.velocity, r.force, r.force_deviation, report::ColorRole::kFirst);
  return {
      .id = "friction_law",
      .title = "Friction law",
      .caption =
          "Left: medians of cells of slip speed with the 5 and 95 % quantiles of their samples. "
          "Right: the bars are 95 % bands under the sensors' noise, what the band limit cuts off "
          "and a wrong law not counted. The linear estimate assumes no law; the model-based one "
          "lies on its own.",
      .columns = 2,
      .panels = {std::move(curve), std::move(loop)},
      .command = command};
}

report::Figure model_force_figure(const Observation& observation,
                                  const ModelIdentification& identification, double start,
                                  double duration, const std::string& command) {
  const double rate = observation.sample_rate;
  const auto first = static_cast<std::size_t>(std::max(0.0, start * rate));
  const std::size_t last = std::min(identification.result.force.size(),
                                    first + static_cast<std::size_t>(duration * rate) + 1);
  report::Panel panel{.title = "Friction force",
                      .x = {.label = "t", .unit = "s"},
                      .y = {.label = "f_c", .unit = "N"}};
  const auto add = [&](const char* label, const std::vector<double>& samples,
                       report::SeriesStyle style, report::ColorRole color) {
    report::Series series{.label = label, .style = style, .color = color};
    for (std::size_t k = first; k < last; ++k) {
      series.x.push_back(static_cast<double>(k) / rate);
      series.y.push_back(samples[k]);
    }
    panel.series.push_back(std::move(series));
  };
  add("linear", identification.result.linear_force, report::SeriesStyle::kLine,
      report::ColorRole::kMuted);
  add("model-based", identification.result.force, report::SeriesStyle::kLine,
      report::ColorRole::kFirst);
  if (observation.reference) {
    add("truth", observation.reference->samples, report::SeriesStyle::kDotted,
        report::ColorRole::kReference);
  }
  return {.id = "model_based_force",
          .title = "Contact force, model-based and linear",
          .caption =
              "The model-based estimate assumes a friction law of the exponential family; "
              "the linear one assumes none.",
          .panels = {std::move(panel)},
          .command = command};
}

}  // namespace modcal
