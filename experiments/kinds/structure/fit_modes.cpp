#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/kinds/lint.hpp"
#include "experiments/kinds/structure/structure_kinds.hpp"
#include "experiments/report/result.hpp"

namespace modcal {
namespace {

using report::Series;

struct ModesOutcome {
  const LoadedStructureRecord& loaded;
  const StrikeFit& fit;

  void visit(ResultVisitor& visitor) const {
    const StructureTable& table = fit.table;
    std::vector<std::size_t> modes(table.model.poles.size()), sensors(loaded.kinds.size());
    for (std::size_t n = 0; n < modes.size(); ++n) modes[n] = n;
    for (std::size_t k = 0; k < sensors.size(); ++k) sensors[k] = k;
    visitor.rows(
        {.key = "modes",
         .table = "modes",
         .name = "Modes",
         .meaning = "Pairs of poles common to all sensors, with the standard deviations "
                    "of the fit. Another strike may differ by more than these."},
        modes, [&](ResultVisitor& row, std::size_t n) {
          const double frequency = table.frequency(n);
          row({.key = "n", .name = "mode"}, n + 1);
          row({.key = "f_hz", .name = "frequency", .unit = "Hz", .format = "{:.6g}"}, frequency);
          row({.key = "f_sd_hz", .name = "its deviation", .unit = "Hz", .format = "{:.2g}"},
              frequency * table.frequency_deviations[n]);
          row({.key = "zeta", .name = "damping ratio"}, table.model.poles[n].zeta);
          row({.key = "zeta_sd", .name = "its deviation", .format = "{:.2g}"},
              table.model.poles[n].zeta * table.damping_deviations[n]);
        });
    visitor.rows({.key = "sensors",
                  .table = "sensors",
                  .name = "Sensors",
                  .meaning = "What the model leaves of each response, and what that says of the "
                             "model's scatter about a mode and of the noise."},
                 sensors, [&](ResultVisitor& row, std::size_t k) {
                   row({.key = "channel"}, loaded.names[k]);
                   row({.key = "kind"}, name_of(loaded.kinds[k]));
                   row({.key = "left", .name = "left of the response", .format = "{:.3g}"},
                       fit.residuals[k]);
                   row({.key = "scatter", .format = "{:.3g}"}, table.scatters[k].modal);
                   row({.key = "noise_rms", .name = "noise", .format = "{:.3g}"},
                       table.scatters[k].noise);
                 });
    visitor.rows({.key = "steps", .shown = ResultVisitor::kInJson}, fit.steps,
                 [](ResultVisitor& row, const ModeCount& step) {
                   row({.key = "modes"}, step.modes);
                   row({.key = "misfit"}, step.misfit);
                   row({.key = "criterion"}, step.criterion);
                 });
    visitor({.key = "contour_per_s"}, fit.spectra.grid.sigma);
    visitor({.key = "rest_s"}, loaded.rest);
    visitor({.key = "misfit"}, fit.misfit);
  }
};

report::Figure criterion_figure(const StrikeFit& fit) {
  Series criterion{.label = "BIC", .style = report::SeriesStyle::kLineWithPoints};
  for (const ModeCount& step : fit.steps) {
    criterion.add(static_cast<double>(step.modes), step.criterion);
  }
  const auto chosen = static_cast<double>(fit.table.model.poles.size());
  return {.id = "criterion",
          .title = "How many modes the record tells",
          .caption = "Bayesian information criterion over the number of modes; the least is taken.",
          .panels = {{.x = {.label = "number of modes"},
                      .y = {.label = "BIC"},
                      .series = {std::move(criterion)},
                      .markers = {{.value = chosen, .label = "taken"}}}}};
}

report::Figure responses_figure(const LoadedStructureRecord& loaded, const StrikeFit& fit) {
  report::Figure figure{
      .id = "responses",
      .title = "Responses to the strike and the model's",
      .caption =
          "Magnitude of response over force on the contour of the fit, and of what the model "
          "leaves of it.",
      .columns = loaded.kinds.size() > 1 ? 2u : 1u};
  for (std::size_t k = 0; k < loaded.kinds.size(); ++k) {
    Series measured{.label = "measured", .color = report::ColorRole::kReference};
    Series modeled{.label = "model"};
    Series left{.label = "left", .color = report::ColorRole::kMuted};
    for (std::size_t m = 0; m < fit.spectra.count(); ++m) {
      const double at = fit.spectra.s(m).imag() / (2.0 * std::numbers::pi);
      const Complex y = fit.spectra.responses[k][m], f = fit.spectra.force[m];
      measured.add(at, std::abs(y / f));
      modeled.add(at, std::abs(fit.modeled[k][m] / f));
      left.add(at, std::abs((y - fit.modeled[k][m]) / f));
    }
    figure.panels.push_back({.title = loaded.names[k],
                             .x = {.label = "frequency", .unit = "Hz"},
                             .y = {.label = fmt::format("{} over force", name_of(loaded.kinds[k])),
                                   .unit = fmt::format("{}/N", unit_of(loaded.kinds[k])),
                                   .logarithmic = true},
                             .series = {std::move(left), std::move(measured), std::move(modeled)}});
  }
  return figure;
}

std::string sentence_of(const StrikeFit& fit, const FitModesOptions& options) {
  const auto [least, most] = std::ranges::minmax(fit.residuals);
  return fmt::format(
      "{} modes between {:g} and {:g} Hz; the model leaves {:.2g} to {:.2g} % of the responses\n",
      fit.table.model.poles.size(), options.low, options.high, 100.0 * least, 100.0 * most);
}

}  // namespace

std::vector<Finding> lint_structure_record(const StructureRecordOptions& record) {
  std::vector<Finding> findings;
  const std::size_t sensors = record.responses.size();
  if (sensors < 1 || sensors > 16) {
    add_finding(findings, "record.responses", "{} responses: state the channels of 1 to 16 sensors",
                sensors);
  }
  return findings;
}

void FitModesOptions::visit(OptionVisitor& visitor) {
  visitor("record", "a strike from rest, force and responses", {.required = true}, record);
  visitor("low", "least frequency of the band that is fitted",
          {.unit = "Hz", .range = Range::positive(), .required = true}, low);
  visitor("high", "largest frequency of the band that is fitted",
          {.unit = "Hz", .range = Range::positive(), .required = true}, high);
  visitor("contour",
          "the record is weighted by exp(-contour t): a real structure departs from its model the "
          "longer it rings; automatic: 20 over the record's duration, at most high/50",
          {.unit = "1/s", .range = Range::positive(), .word = "automatic"}, contour);
  visitor("most_modes", "no more are tried", {.range = Range::closed(1.0, 200.0)}, most_modes);
}

std::vector<Finding> FitModesOptions::lint() const {
  std::vector<Finding> findings = lint_structure_record(record);
  if (!record.has_force) {
    add_finding(findings, "record",
                "modes are fitted to responses and the force that made them: name its channel "
                "(force: {{channel: ...}})");
  }
  if (!(low < high)) {
    add_finding(findings, "high", "{:g} Hz is not above low, {:g} Hz", high, low);
  }
  return findings;
}

std::vector<Finding> FitModesOptions::lint_records(const std::filesystem::path& folder) const {
  std::vector<Finding> findings;
  lint_making(findings, "record", [&] {
    const LoadedStructureRecord loaded = load_structure_record(record, folder);
    MODCAL_REQUIRE(high < 0.5 * loaded.record.sample_rate,
                   "high = {:g} Hz is not below half the sample rate {:g} Hz: state less", high,
                   loaded.record.sample_rate);
  });
  return findings;
}

std::vector<PlanLine> FitModesOptions::plan() const {
  return {{fmt::format("fit modes between {:g} and {:g} Hz to {} responses of {}", low, high,
                       record.responses.size(), record.file),
           {{"low", low},
            {"high", high},
            {"responses", record.responses.size()},
            {"record", record.file}}}};
}

StudyResult FitModesOptions::run(const StudyContext& context) const {
  const LoadedStructureRecord loaded = load_structure_record(record, context.folder);
  context.throw_if_interrupted();
  StrikeFit fit = fit_strike(loaded.record, loaded.kinds,
                             {.low = low,
                              .high = high,
                              .sigma = contour,
                              .most_modes = static_cast<std::size_t>(most_modes)});
  fit.table.names = loaded.names;
  StudyResult result;
  result.summary = sentence_of(fit, *this);
  result.answer_by_summary();
  for (const std::string& text : loaded.warnings) result.warn(text);
  if (const std::string why = fit.rejection(); !why.empty()) {
    result.status = report::Status::kFailed;
    result.answer = why;
    result.warn(why);
  }
  if (!context.numbers_alone) {
    result.blocks.emplace_back(responses_figure(loaded, fit));
  }
  const ModesOutcome outcome{loaded, fit};
  result.add(report::tables_of(outcome));
  if (!context.numbers_alone) result.blocks.emplace_back(criterion_figure(fit));
  result.files.emplace_back("table.yaml", table_text(fit.table));
  result.files.emplace_back("modes_fit.json", report::json_file(report::json_of(outcome)));
  return result;
}

}  // namespace modcal
