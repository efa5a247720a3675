#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/kinds/lint.hpp"
#include "experiments/kinds/structure/modes_figures.hpp"
#include "experiments/kinds/structure/structure_kinds.hpp"
#include "experiments/report/result.hpp"
#include "libsim/records/universal/universal_modes.hpp"

namespace modcal {
namespace {

struct ModesOutcome {
  const StrikeFit& fit;
  double rest;  // of which the mean was taken [s]; NaN: response functions

  void visit(ResultVisitor& visitor) const {
    const StructureTable& table = fit.table;
    std::vector<std::size_t> modes(table.model.poles.size()), sensors(table.names.size());
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
                   row({.key = "channel"}, table.names[k]);
                   row({.key = "kind"}, name_of(table.model.sensors[k]));
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
    visitor({.key = "rest_s"}, known(rest));
    visitor({.key = "misfit"}, fit.misfit);
  }
};

std::string sentence_of(const StrikeFit& fit, const FitModesOptions& options) {
  const auto [least, most] = std::ranges::minmax(fit.residuals);
  return fmt::format(
      "{} modes between {:g} and {:g} Hz; the model leaves {:.2g} to {:.2g} % of the responses\n",
      fit.table.model.poles.size(), options.low, options.high, 100.0 * least, 100.0 * most);
}

}  // namespace

FileRead file_read(const StructureRecordOptions& record) {
  return {.name = record.file,
          .key = "record.file",
          .format = record.format,
          .channels = static_cast<double>(record.responses.size() + (record.has_force ? 1 : 0))};
}

std::vector<FileRead> FitModesOptions::files_read() const {
  if (!has_functions) return {file_read(record)};
  std::vector<FileRead> files;
  for (const std::string& file : functions.files()) {
    files.push_back({.name = file, .key = files.empty() ? "functions.file" : "functions.sessions"});
  }
  return files;
}

std::vector<Finding> lint_responses(const std::string& path, std::size_t sensors) {
  std::vector<Finding> findings;
  if (sensors < 1 || sensors > 16) {
    add_finding(findings, path, "{} responses: state the channels of 1 to 16 sensors", sensors);
  }
  return findings;
}

void FitModesOptions::visit(OptionVisitor& visitor) {
  visitor("record", "a strike from rest, force and responses", has_record, record);
  visitor("functions", "measured response functions in the place of a record", has_functions,
          functions);
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

namespace {

// What changes between sessions moves whole resonances, which no scatter of single lines tells.
void lint_one_session(const ResponseFunctionOptions& functions, std::vector<Finding>& findings) {
  if (!functions.sessions.empty()) {
    add_finding(findings, "functions.sessions",
                "modes are fitted to one session, as what changes between them moves whole "
                "resonances: fit modes to each; a table of functions (functions: in the file that "
                "identify_force reads) takes them together");
  }
  const bool told = std::ranges::any_of(
      functions.responses,
      [](const FunctionChannelOptions& response) { return !response.coherence.empty(); });
  if (told || !std::isnan(functions.averages)) {
    add_finding(findings, told ? "functions.responses" : "functions.averages",
                "a coherence of few averages scatters too much to weigh lines by: leave coherence "
                "and averages out; a table of functions takes them");
  }
}

}  // namespace

std::vector<Finding> FitModesOptions::lint() const {
  std::vector<Finding> findings =
      has_functions ? lint_responses("functions.responses", functions.responses.size())
                    : lint_responses("record.responses", record.responses.size());
  if (has_record == has_functions) {
    findings.clear();
    add_finding(
        findings, has_record ? "functions" : "",
        "modes are fitted to one of both: state record: (a strike whose force was measured) or "
        "functions: (response functions)");
  } else if (has_record && !record.has_force) {
    add_finding(findings, "record",
                "modes are fitted to responses and the force that made them: name its channel "
                "(force: {{channel: ...}})");
  } else if (has_functions && !std::isnan(contour)) {
    add_finding(findings, "contour",
                "response functions are known on one contour alone: leave contour out");
  }
  if (has_functions) lint_one_session(functions, findings);
  if (!(low < high)) {
    add_finding(findings, "high", "{:g} Hz is not above low, {:g} Hz", high, low);
  }
  return findings;
}

std::vector<Finding> FitModesOptions::lint_records(const std::filesystem::path& folder) const {
  std::vector<Finding> findings;
  const auto require_band = [this](double most, std::string_view what) {
    MODCAL_REQUIRE(high < most, "high = {:g} Hz is not below {} {:g} Hz: state less", high, what,
                   most);
  };
  if (has_functions) {
    lint_making(findings, "functions", [&] {
      const FrequencyGrid grid = load_response_functions(functions, folder).measured.grid;
      require_band(grid.omega(grid.bins) / (2.0 * std::numbers::pi), "the last line,");
    });
    return findings;
  }
  lint_making(findings, "record", [&] {
    require_band(0.5 * load_structure_record(record, folder).record.sample_rate,
                 "half the sample rate");
  });
  return findings;
}

std::vector<PlanLine> FitModesOptions::plan() const {
  const std::size_t count = has_functions ? functions.responses.size() : record.responses.size();
  const std::string file = files_read().front().name;
  return {{fmt::format("fit modes between {:g} and {:g} Hz to {} {} of {}", low, high, count,
                       has_functions ? "response functions" : "responses", file),
           {{"low", low}, {"high", high}, {"responses", count}, {"record", file}}}};
}

namespace {

struct Fitted {
  StrikeFit fit;
  double rest = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::string> warnings;
};

Fitted fit_of(const FitModesOptions& options, const StudyContext& context) {
  const StrikeFitOptions how{.low = options.low,
                             .high = options.high,
                             .sigma = options.contour,
                             .most_modes = static_cast<std::size_t>(options.most_modes)};
  Fitted fitted;
  if (options.has_functions) {
    LoadedResponseFunctions loaded = load_response_functions(options.functions, context.folder);
    context.throw_if_interrupted();
    fitted.fit = fit_response(loaded.measured, how);
    fitted.fit.table.names = std::move(loaded.names);
    fitted.warnings = std::move(loaded.warnings);
    return fitted;
  }
  LoadedStructureRecord loaded =
      load_structure_record(options.record, context.folder, context.stop);
  context.throw_if_interrupted();
  fitted.fit = fit_strike(loaded.record, loaded.kinds, how);
  fitted.fit.table.names = std::move(loaded.names);
  fitted.rest = loaded.rest;
  fitted.warnings = std::move(loaded.warnings);
  return fitted;
}

}  // namespace

StudyResult FitModesOptions::run(const StudyContext& context) const {
  const Fitted fitted = fit_of(*this, context);
  const StrikeFit& fit = fitted.fit;
  StudyResult result;
  result.summary = sentence_of(fit, *this);
  result.answer_by_summary();
  for (const std::string& text : fitted.warnings) result.warn(text);
  std::string why = fit.rejection();
  // Without a window it is one mode too many, of what rounding leaves.
  const bool windowed = !std::isnan(has_functions ? functions.window : record.window);
  if (why.empty() && windowed && !fit.without_damping().empty()) {
    why = fit.without_damping() + ": state a longer exponential_window";
  }
  if (!why.empty()) {
    result.status = report::Status::kFailed;
    result.answer = why;
    result.warn(why);
  }
  if (!context.numbers_alone) {
    result.blocks.emplace_back(responses_figure(fit));
  }
  const ModesOutcome outcome{fit, fitted.rest};
  result.add(report::tables_of(outcome));
  if (!context.numbers_alone) {
    result.blocks.emplace_back(criterion_figure(fit));
    result.blocks.emplace_back(stabilization_figure(fit));
  }
  result.files.emplace_back("table.yaml", table_text(fit.table));
  if (std::ranges::all_of(fit.table.model.sensors, is_motion)) {
    result.files.emplace_back("modes.uff", universal_modes_text(fit.table.model, fit.table.names));
  }
  result.files.emplace_back("modes_fit.json", report::json_file(report::json_of(outcome)));
  return result;
}

}  // namespace modcal
