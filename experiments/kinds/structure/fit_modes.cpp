#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/kinds/lint.hpp"
#include "experiments/kinds/structure/modes_figures.hpp"
#include "experiments/kinds/structure/modes_outcome.hpp"
#include "experiments/kinds/structure/structure_kinds.hpp"
#include "libsim/records/record_keys.hpp"
#include "libsim/records/universal/universal_modes.hpp"

namespace modcal {

FileRead file_read(const StructureRecordOptions& record) {
  return {.name = record.file,
          .key = "record.file",
          .format = record.format,
          .channels = static_cast<double>(record.responses.size() + (record.has_force ? 1 : 0))};
}

std::vector<FileRead> FitModesOptions::files_read() const {
  std::vector<FileRead> files;
  if (!has_functions) {
    for (const StructureRecordOptions& strike : strikes()) {
      files.push_back(file_read(strike));
      if (files.size() > 1) files.back().key = "other_strikes";
    }
    return files;
  }
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

std::vector<StructureRecordOptions> FitModesOptions::strikes() const {
  std::vector<StructureRecordOptions> all = {record};
  for (const OtherStrikeOptions& other : other_strikes) {
    StructureRecordOptions& strike = all.emplace_back(record);
    if (!other.file.empty()) strike.file = other.file;
    strike.start = other.start, strike.stop = other.stop;
  }
  return all;
}

std::vector<std::string> FitModesOptions::strike_names() const {
  if (has_functions) return functions.files();
  std::vector<std::string> names;
  for (const StructureRecordOptions& strike : strikes()) {
    names.push_back(strike.start > 0.0 ? fmt::format("{} from {:g} s", strike.file, strike.start)
                                       : strike.file);
  }
  return names;
}

void OtherStrikeOptions::visit(OptionVisitor& visitor) {
  visitor("file", "file of the same channels; none: that of record", file);
  visit_record_part(visitor, *this);
}

void FitModesOptions::visit(OptionVisitor& visitor) {
  visitor("record", "a strike from rest, force and responses", has_record, record);
  visitor(
      "other_strikes",
      "strikes at the same place, in files of the same channels or other parts of the record's: "
      "modes are fitted to all, and their deviations are those of a further strike",
      other_strikes);
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

// A strike that counts twice would tell that strikes do not differ.
void lint_overlap(const std::vector<StructureRecordOptions>& strikes,
                  std::vector<Finding>& findings) {
  const auto end_of = [](const StructureRecordOptions& strike) {
    return std::isnan(strike.stop) ? std::numeric_limits<double>::infinity() : strike.stop;
  };
  for (std::size_t i = 0; i < strikes.size(); ++i) {
    for (std::size_t j = i + 1; j < strikes.size(); ++j) {
      const StructureRecordOptions &a = strikes[i], &b = strikes[j];
      if (a.file != b.file || a.start >= end_of(b) || b.start >= end_of(a)) continue;
      add_finding(
          findings, "other_strikes",
          "strikes {} and {} overlap in {}: state start and stop of each, in the record, too",
          i + 1, j + 1, a.file);
    }
  }
}

void lint_coherence(const ResponseFunctionOptions& functions, std::vector<Finding>& findings) {
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
  if (has_functions) lint_coherence(functions, findings);
  if (has_record) lint_overlap(strikes(), findings);
  if (has_functions && !other_strikes.empty()) {
    add_finding(findings, "other_strikes",
                "response functions have no strikes: name files of further measurements in "
                "functions.sessions");
  }
  if (!(low < high)) {
    add_finding(findings, "high", "{:g} Hz is not above low, {:g} Hz", high, low);
  }
  return findings;
}

std::vector<Finding> FitModesOptions::lint_records(const std::filesystem::path& folder) const {
  std::vector<Finding> findings;
  const auto require_band = [this](double most, std::string_view what) {
    if (high < most) return;
    throw WrongKey("high", fmt::format("high = {:g} Hz is not below {} {:g} Hz: state less", high,
                                       what, most));
  };
  if (has_functions) {
    lint_making(findings, "functions", [&] {
      const FrequencyGrid grid = load_response_functions(functions, folder).measured.grid;
      require_band(grid.omega(grid.bins) / (2.0 * std::numbers::pi), "the last line,");
    });
    return findings;
  }
  for (const StructureRecordOptions& strike : strikes()) {
    lint_making(findings,
                findings.empty() && strike.file == record.file ? "record" : "other_strikes", [&] {
                  require_band(0.5 * load_structure_record(strike, folder).record.sample_rate,
                               "half the sample rate");
                });
    if (!findings.empty()) break;
  }
  return findings;
}

std::vector<PlanLine> FitModesOptions::plan() const {
  const std::size_t count = has_functions ? functions.responses.size() : record.responses.size();
  const std::vector<std::string> names = strike_names();
  const std::string also = names.size() > 1
                               ? fmt::format(" and {} {}", names.size() - 1,
                                             has_functions ? "further sessions" : "other strikes")
                               : "";
  return {{fmt::format("fit modes between {:g} and {:g} Hz to {} {} of {}{}", low, high, count,
                       has_functions ? "response functions" : "responses", names.front(), also),
           {{"low", low}, {"high", high}, {"responses", count}, {"record", names.front()}}}};
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
  std::vector<LoadedStructureRecord> loaded;
  std::vector<StructureRecord> records;
  for (const StructureRecordOptions& strike : options.strikes()) {
    loaded.push_back(load_structure_record(strike, context.folder, context.stop));
    context.throw_if_interrupted();
    require_whole_blow(loaded.back().record, strike.file);
    for (const std::string& text : loaded.back().warnings) {
      if (std::ranges::count(fitted.warnings, text) == 0) fitted.warnings.push_back(text);
    }
    records.push_back(std::move(loaded.back().record));
  }
  fitted.fit = fit_strikes(std::move(records), loaded.front().kinds, how);
  fitted.fit.table.names = std::move(loaded.front().names);
  fitted.rest = loaded.front().rest;
  return fitted;
}

std::string frequencies_of(const std::vector<std::size_t>& modes, const StrikeFit& fit) {
  std::vector<std::string> some;
  for (const std::size_t n : modes) some.push_back(fmt::format("{:.5g}", fit.table.frequency(n)));
  return fmt::format("{}", fmt::join(some, ", "));
}

void warn_of_modes(const StrikeFit& fit, StudyResult& result) {
  const auto warn = [&](const std::vector<std::size_t>& modes, std::string_view text) {
    std::vector<std::size_t> rest;
    std::ranges::set_difference(modes, fit.stand_ins, std::back_inserter(rest));
    if (!rest.empty()) result.warn(fmt::format(fmt::runtime(text), frequencies_of(rest, fit)));
  };
  warn(fit.disputed,
       "the sensors do not agree on the modes at {} Hz, as where two that stand close together are "
       "taken for one: their deviations are wide by that; a longer record, contour: with a smaller "
       "one, or a sensor elsewhere may part them");
  warn(fit.doubled,
       "what rings late tells of two modes in the place of each of those at {} Hz: two stand close "
       "together, or the frequency of one falls with its amplitude; their deviations are wide by "
       "that, and contour: with a smaller one parts two");
  if (fit.stand_ins.empty()) return;
  result.warn(fmt::format(
      "modes at {} Hz may be none of the structure's, but stand for what no other mode explains: "
      "they lie outside of the band, or their frequency is told to no better than a third of their "
      "half-width",
      frequencies_of(fit.stand_ins, fit)));
}

}  // namespace

StudyResult FitModesOptions::run(const StudyContext& context) const {
  const Fitted fitted = fit_of(*this, context);
  const StrikeFit& fit = fitted.fit;
  StudyResult result;
  result.summary = sentence_of(fit, *this);
  result.answer_by_summary();
  for (const std::string& text : fitted.warnings) result.warn(text);
  const std::vector<std::string> names = strike_names();
  std::string why = fit.strikes.size() > 1 ? fit.rejection(names) : fit.rejection();
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
  warn_of_modes(fit, result);
  if (!context.numbers_alone) {
    result.blocks.emplace_back(responses_figure(fit));
  }
  const ModesOutcome outcome{fit, names, fitted.rest};
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
