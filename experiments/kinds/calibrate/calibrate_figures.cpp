// Figures of a calibration: those asked for, and what every one with standard deviations shows.
#include <cmath>
#include <numeric>
#include <set>

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/report/result.hpp"
#include "libinverse/joint/string_transfer.hpp"

namespace modcal {
namespace {

using report::ColorRole;
using report::Series;
using report::SeriesStyle;

constexpr double kBand = 1.96;  // deviations of 95 %

double law_frequency(const FoundLaw& law, double n) {
  return n * law.fundamental * std::sqrt(1.0 + law.inharmonicity * n * n);
}

// Of the modes that the record tells by themselves, or of all others.
Series departures(const CalibrationOutcome& outcome, bool identified) {
  const ContinuationResult& found = *outcome.result.continuation;
  Series series{.label = identified ? "identified, 95 % bar" : "from law, prior or stated",
                .style = SeriesStyle::kPoints,
                .color = identified ? ColorRole::kFirst : ColorRole::kMuted};
  for (std::size_t i = 0; i < found.modes.size(); ++i) {
    const ModeVerdict& mode = found.modes[i];
    if ((mode.source == ModeSource::kIdentified) != identified) continue;
    const auto n = static_cast<double>(i + 1);
    const double law = law_frequency(found.found_law, n);
    const double departure = 1e3 * (outcome.refined.basis.frequency(i) / law - 1.0);
    const double width = 1e3 * kBand * mode.deviation;
    series.add(n, departure, departure - width, departure + width);
  }
  return series;
}

report::Figure law_figure(const CalibrationOutcome& outcome) {
  const FoundLaw& law = outcome.result.continuation->found_law;
  report::Figure figure{
      .id = "frequencies_against_law",
      .title = "Modal frequencies against the law",
      .caption = fmt::format(
          "f_n over n f_0 √(1 + B n²) with f_0 = {:.6g} Hz and B = {}. Bars: 95 %; grey: "
          "what the data do not tell by themselves.",
          law.fundamental, inharmonicity_text(law.inharmonicity, law.deviation[1]))};
  report::Panel panel{.x = {.label = "mode number n"},
                      .y = {.label = "departure from the law", .unit = "‰"}};
  for (const bool identified : {true, false}) {
    Series series = departures(outcome, identified);
    if (!series.x.empty()) panel.series.push_back(std::move(series));
  }
  if (!outcome.true_frequencies.empty()) {
    Series truth{.label = "true", .style = SeriesStyle::kDashed, .color = ColorRole::kReference};
    for (std::size_t i = 0; i < outcome.true_frequencies.size(); ++i) {
      const auto n = static_cast<double>(i + 1);
      truth.add(n, 1e3 * (outcome.true_frequencies[i] / law_frequency(law, n) - 1.0));
    }
    panel.series.push_back(std::move(truth));
  }
  panel.markers.push_back({.direction = report::Marker::Direction::kHorizontal, .label = "law"});
  figure.panels.push_back(std::move(panel));
  return figure;
}

// |Σ R₁ conj(R₂)| over Σ |R₂|² of every band of a spectrum, or of H₁ and H₂.
Series ratio_of(std::span<const Complex> left, std::span<const Complex> right, double width,
                std::size_t bins, double highest) {
  Series series;
  for (std::size_t k = 1; k + bins <= left.size(); k += bins) {
    Complex mixed = 0.0;
    double power = 0.0;
    for (std::size_t i = k; i < k + bins; ++i) {
      mixed += left[i] * std::conj(right[i]);
      power += std::norm(right[i]);
    }
    const double f = (static_cast<double>(k) + 0.5 * static_cast<double>(bins - 1)) * width;
    if (f > highest) break;
    if (power > 0.0) series.add(1e-3 * f, std::abs(mixed) / power);
  }
  return series;
}

// The force cancels in R₁/R₂ = H₁/H₂, the one transfer function that a stroke measures.
report::Figure ratio_figure(const CalibrationOutcome& outcome, const Observation& observation,
                            const StringSupport& support) {
  report::Figure figure{.id = "reaction_ratio",
                        .title = "Ratio of the reactions, measured and of the model",
                        .caption =
                            "The force cancels in R_1 / R_2 = H_1 / H_2. Averaged over a tenth of "
                            "f_0; noise fills the zeros of the measured one."};
  const auto& left = observation.reaction(End::kLeft);
  const auto& right = observation.reaction(End::kRight);
  if (!left || !right) return figure;
  const double width = observation.sample_rate / static_cast<double>(observation.samples());
  const double highest = outcome.refined.basis.frequency(outcome.refined.basis.size() - 1);
  const auto bins =
      std::max<std::size_t>(1, static_cast<std::size_t>(0.1 * observation.fundamental / width));
  report::Panel panel{.x = {.label = "frequency", .unit = "kHz"},
                      .y = {.label = "|R_1/R_2|", .logarithmic = true}};
  const RealFft fft(observation.samples());
  panel.series.push_back(
      ratio_of(fft.forward(left->samples), fft.forward(right->samples), width, bins, highest));
  panel.series.back().label = "measured";
  panel.series.back().color = ColorRole::kMuted;
  const auto add = [&](const AssumedModel& model, const char* label, SeriesStyle style,
                       ColorRole color) {
    const StringTransfer transfer = string_transfer(
        model.basis, model.contact,
        FrequencyGrid::of_record(observation.samples(), observation.sample_rate), support, {});
    Series series = ratio_of(transfer.reaction[0], transfer.reaction[1], width, bins, highest);
    series.label = label;
    series.style = style;
    series.color = color;
    panel.series.push_back(std::move(series));
  };
  add(outcome.initial, "initial model", SeriesStyle::kDashed, ColorRole::kSecond);
  add(outcome.refined, "refined model", SeriesStyle::kLine, ColorRole::kFirst);
  figure.panels.push_back(std::move(panel));
  return figure;
}

std::vector<std::size_t> all_of(const NamedCovariance& covariance) {
  std::vector<std::size_t> all(covariance.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// Of a fit with every frequency free: what is of no mode, and both of the strongest pairs.
std::vector<std::size_t> tightly_bound(const ContinuationResult& found) {
  const std::vector<std::string>& names = found.covariance.names;
  std::set<std::size_t> bound;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto name = parse_parameter(names[i]);
    if (name && !type_of(*name).of_mode) bound.insert(i);
  }
  for (const CorrelatedPair& pair : tightest_pairs(found)) {
    bound.insert({pair.first, pair.second});
  }
  return {bound.begin(), bound.end()};
}

}  // namespace

std::vector<report::Figure> calibration_overview(const CalibrationOutcome& outcome,
                                                 const Observation& observation,
                                                 const StringSupport& support) {
  if (!outcome.result.continuation) return {};
  std::vector<report::Figure> figures = {law_figure(outcome),
                                         ratio_figure(outcome, observation, support)};
  std::erase_if(figures, [](const report::Figure& figure) { return figure.panels.empty(); });
  return figures;
}

report::Table correlation_map(const ContinuationResult& found) {
  const bool of_law = found.tells_of_law();
  const NamedCovariance& covariance = of_law ? found.law.covariance : found.covariance;
  const std::vector<std::size_t> shown = of_law ? all_of(covariance) : tightly_bound(found);
  report::Table map{.id = "correlation_map",
                    .title = "Correlations of the parameters",
                    .caption = of_law ? "Of the fit in which the frequencies obey the law."
                                      : "Of the modes those that are bound most tightly."};
  map.caption += " The darker, the less the data tell the two apart.";
  const Eigen::MatrixXd correlations = covariance.correlations();
  for (const std::size_t i : shown) {
    report::add_row(map, [&](report::RowWriter& row) {
      row({.key = "parameter"}, covariance.names[i]);
      for (const std::size_t j : shown) {
        const double r = correlations(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
        report::Cell cell = i == j ? report::Cell() : report::Cell(r);
        if (i != j) cell.heat = std::abs(r);
        row.cell({.key = covariance.names[j], .format = "{:+.2f}"}, std::move(cell));
      }
    });
  }
  return map;
}

report::Figure objective_figure(const FigureOptions& options, const CalibrationOutcome& outcome) {
  report::Figure figure{.id = options.id, .title = options.title, .columns = 3};
  figure.caption =
      "First loop over the candidates; dotted: true frequency; square: the candidate "
      "chosen in the last loop.";
  for (const CoordinateScan& scan : outcome.result.search.scans) {
    if (scan.loop != 1) continue;
    const CalibratedParameter& parameter = outcome.result.parameters[scan.variable];
    if (!parameter.name.starts_with("f_")) continue;
    const auto n = static_cast<std::size_t>(std::stoul(parameter.name.substr(2)));
    if (n > static_cast<std::size_t>(options.modes)) continue;
    report::Panel panel;
    panel.title = fmt::format("mode {}", n);
    panel.x = {.label = fmt::format("f_{}", n), .unit = "Hz"};
    panel.y = {.label = "C", .unit = "N"};
    panel.series.push_back({.label = "objective, first loop",
                            .x = scan.candidates,
                            .y = scan.values,
                            .style = SeriesStyle::kLineWithPoints});
    for (const CoordinateScan& last : outcome.result.search.scans) {
      if (last.variable != scan.variable || last.loop == 1) continue;
      const auto best = std::min_element(last.values.begin(), last.values.end());
      panel.series.push_back({.label = fmt::format("chosen, loop {}", last.loop),
                              .x = {last.chosen},
                              .y = {*best},
                              .style = SeriesStyle::kPoints,
                              .color = ColorRole::kSecond});
    }
    if (!outcome.true_frequencies.empty()) {
      panel.markers.push_back({.value = outcome.true_frequencies[n - 1], .label = "true"});
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

report::Figure frequency_error_figure(const FigureOptions& options,
                                      const CalibrationOutcome& outcome) {
  report::Figure figure{.id = options.id, .title = options.title, .columns = 1};
  figure.caption = "Blind: modes with a node at the contact, which does not excite them.";
  report::Series absolute[2], relative[2], shape[2];
  for (const CalibratedMode& mode : outcome.result.modes) {
    const std::size_t group = mode.excited ? 0 : 1;
    const auto n = static_cast<double>(mode.number);
    shape[group].add(n, std::abs(mode.shape));
    if (outcome.true_frequencies.empty()) continue;
    const double truth = outcome.true_frequencies[mode.number - 1];
    const double error = outcome.refined.basis.frequency(mode.number - 1) - truth;
    absolute[group].add(n, std::abs(error));
    relative[group].add(n, 100.0 * std::abs(error) / truth);
  }
  const auto add = [&figure](report::Series* series, report::Axis y) {
    report::Panel panel;
    panel.x = {.label = "mode number n"};
    panel.y = std::move(y);
    for (int group = 0; group < 2; ++group) {
      if (series[group].x.empty()) continue;
      series[group].label = group == 0 ? "excited" : "blind";
      series[group].style = SeriesStyle::kPoints;
      series[group].color = group == 0 ? ColorRole::kFirst : ColorRole::kSecond;
      panel.series.push_back(std::move(series[group]));
    }
    figure.panels.push_back(std::move(panel));
  };
  if (!outcome.true_frequencies.empty()) {
    add(absolute, {.label = "|f_n − true|", .unit = "Hz"});
    add(relative, {.label = "relative error", .unit = "%"});
  }
  add(shape, {.label = "|φ_n(x_c)|"});
  return figure;
}

}  // namespace modcal
