#include "experiments/kinds/invert/invert.hpp"

#include "experiments/kinds/lint.hpp"
#include "experiments/report/result.hpp"
#include "experiments/study/observation.hpp"
#include "libinverse/waves/wave_reconstruction.hpp"

namespace modcal {
namespace {

struct Method {
  const char* name;
  decltype(&reconstruct_from_waves) reconstruct;
  OutgoingWave outgoing;
};

constexpr Method kMethods[] = {
    {"ideal string, wave to x = 0", reconstruct_from_waves, OutgoingWave::kLeft},
    {"ideal string, wave to x = L", reconstruct_from_waves, OutgoingWave::kRight},
    {"loss and dispersion, wave to x = 0", reconstruct_with_loss, OutgoingWave::kLeft},
    {"loss and dispersion, wave to x = L", reconstruct_with_loss, OutgoingWave::kRight},
};

}  // namespace

void InvertOptions::visit(OptionVisitor& visitor) {
  observation.visit(visitor);
  visitor("model_error", "errors put into the model that inverts", model_error);
  visitor("inversion", "how the reactions are inverted", inversion);
  visitor("model_based", "observer with a fitted friction law, beside the linear estimates",
          has_model_based, model_based);
  visitor("wave_based", "reconstruct the force from the waves of both reactions as well",
          wave_based);
  visitor("score", "where identified and true force are compared", score);
  visitor("seed", "key of noise and model errors", {.range = Range::non_negative()}, seed);
  visitor("write_signals", "write the identified signals as CSV", write_signals);
  visitor("figures", "what is drawn", figures);
}

std::vector<Finding> lint_inversion(const InvertOptions& options) {
  std::vector<Finding> findings = lint_observation(options.observation);
  lint_making(findings, "inversion", [&] { InversionRecipe recipe(options.inversion); });
  append(findings, lint_scores(options.score, options.observation));
  if (findings.empty() && is_known(options.observation.string_model())) {
    lint_making(findings, "model_error", [&] {
      with_errors(make_modal_basis(options.observation.string_model().before_reading()),
                  options.observation.contact_point(), options.model_error,
                  options.key().with("model error"));
    });
  }
  return findings;
}

std::vector<Finding> InvertOptions::lint() const {
  std::vector<Finding> findings = lint_inversion(*this);
  append(findings, lint_figures(figures, {"waveforms", "spectra", "parameter_curves"}));
  return findings;
}

std::vector<std::string> InvertOptions::plan() const {
  std::vector<std::string> lines;
  const auto planned = planned_simulations();
  lines.push_back(planned ? plan_line(*planned) : "record: " + observation.record.file);
  const InversionOutputs outputs = inversion_outputs(figures, write_signals);
  if (!outputs.displacement)
    lines.emplace_back("skipped: identified displacement, which nobody reads");
  if (!outputs.velocity) lines.emplace_back("skipped: identified velocity, which nobody reads");
  return lines;
}

std::optional<PlannedSimulations> InvertOptions::planned_simulations() const {
  return planned_truths(observation, truth_outputs(figures));
}

OutputRequest truth_outputs(const std::vector<FigureOptions>& figures) {
  OutputRequest request{.force = true, .left_reaction = true, .right_reaction = true};
  for (const FigureOptions& figure : figures) {
    if (figure.content != "waveforms" && figure.content != "spectra") continue;
    for (const std::string& name : figure.quantities) request.*quantity_of(name).wanted = true;
  }
  return request;
}

InversionOutputs inversion_outputs(const std::vector<FigureOptions>& figures, bool all) {
  const OutputRequest drawn = truth_outputs(figures);
  return {
      .force = true, .displacement = all || drawn.displacement, .velocity = all || drawn.velocity};
}

report::Cell side_cell(const std::string& side) {
  if (side == "1" || side == "2") return side[0] - '0';
  return side;
}

report::Table identification_table(const std::vector<SideIdentification>& sides) {
  report::Table table{.id = "identification", .title = "Identification"};
  const bool limited = std::ranges::any_of(sides, [](const SideIdentification& side) {
    return std::isfinite(side.estimate.band_limit);
  });
  const auto add = [&table, limited](const SideIdentification& side, const WindowScore& score) {
    const ChosenParameter& choice = side.estimate.result.choice;
    const bool free = choice.status == ChoiceStatus::kNoParameter;
    const auto parameter = free ? std::nullopt : std::optional(choice.parameter());
    report::add_row(table, [&](report::RowWriter& row) {
      row.cell({.key = "side"}, side_cell(side.estimate.side));
      row({.key = "parameter", .unit = "N/N"}, parameter);
      row({.key = "relative_parameter", .name = "parameter / max|H|"},
          free ? parameter : *parameter / side.estimate.largest_transfer);
      row({.key = "kept_share", .name = "share of bins kept"}, choice.kept_share);
      row({.key = "choice", .name = "parameter choice"}, name_of(choice.status));
      row({}, score);
      row({.key = "force_deviation",
           .name = "standard deviation of the force, posterior",
           .unit = "N"},
          known(side.estimate.force_deviation));
      if (!limited) return;
      row({.key = "velocity_deviation",
           .name = "standard deviation of the velocity, posterior",
           .unit = "m/s"},
          known(side.estimate.velocity_deviation));
      row({.key = "band_limit", .name = "identified up to", .unit = "Hz"},
          known(side.estimate.band_limit));
    });
  };
  for (const SideIdentification& side : sides) {
    if (side.scores.empty()) add(side, {.start = std::nan("")});
    for (const WindowScore& score : side.scores) add(side, score);
  }
  return table;
}

void add_identification_figures(const std::vector<FigureOptions>& figures,
                                const Observation& observation,
                                const std::vector<SideIdentification>& sides, StudyResult& result) {
  for (const FigureOptions& figure : figures) {
    if (figure.content == "objectives" || figure.content == "frequency_errors") continue;
    result.blocks.emplace_back(identification_figure(figure, observation, sides));
  }
}

SignalFile identified_signals(const Observation& observation,
                              const std::vector<SideIdentification>& sides) {
  SignalFile file{.name = "identified.csv"};
  for (const SideIdentification& side : sides) {
    const bool numbered = side.estimate.side.size() == 1;
    for (const std::string_view name : {"f_c", "y", "v"}) {
      const Quantity& quantity = quantity_of(name);
      const std::vector<double>& samples = side.estimate.result.*quantity.identified;
      if (samples.empty()) continue;
      file.signals.push_back({fmt::format("{}{}{}", name, numbered ? "" : "_", side.estimate.side),
                              std::string(quantity.unit), observation.sample_rate, samples});
    }
    const auto add = [&](const char* name, const char* unit, const std::vector<double>& samples) {
      if (samples.empty()) return;
      file.signals.push_back({fmt::format(fmt::runtime(name), side.estimate.side), unit,
                              observation.sample_rate, samples});
    };
    add("f_c_{}_unaliased", "N", side.estimate.unaliased_force);
    add("f_c_{}_deviation", "N", side.estimate.force_deviations);
    add("v_{}_deviation", "m/s", side.estimate.velocity_deviations);
  }
  return file;
}

void add_warnings(const Observation& observation, const std::vector<SideIdentification>& sides,
                  StudyResult& result) {
  for (const std::string& warning : observation.warnings) result.warn(warning);
  for (const SideIdentification& side : sides) {
    for (const std::string& note : side.estimate.notes) {
      result.summary += fmt::format("side {}  {}\n", side.estimate.side, note);
      result.blocks.emplace_back(report::Text{note, report::Text::Kind::kNote});
    }
    for (const std::string& warning : side.estimate.warnings) {
      result.warn(fmt::format("Estimate {}: {}", side.estimate.label, warning));
    }
  }
}

StudyResult InvertOptions::run(const StudyContext& context) const {
  const Observation observed = observe(observation, truth_outputs(figures), context.work.truths,
                                       key(), context.folder, score.oversampling);
  require_told_fundamental(observation, observed);
  const AssumedModel model =
      with_errors(observed.basis, observed.contact, model_error, key().with("model error"));
  const auto sides = identify(observed, model, inversion, inversion_outputs(figures, write_signals),
                              &score, &context.work.inversions);

  StudyResult result;
  if (!observed.modes_taken.empty()) {
    result.summary += observed.modes_taken + "\n";
    result.blocks.emplace_back(report::Text{observed.modes_taken, report::Text::Kind::kNote});
  }
  add_warnings(observed, sides, result);
  add_identification_figures(figures, observed, sides, result);
  result.add({identification_table(sides)});
  if (write_signals) result.signal_files.push_back(identified_signals(observed, sides));
  if (wave_based) add_wave_based(observed, model, score, result);
  if (has_model_based) {
    const ModelIdentification by_model =
        identify_by_model(observed, model, model_based, score, context.stop);
    add_model_based(observed, by_model, score, result);
    if (write_signals) add_model_signals(observed, by_model.result, result.signal_files.back());
  }
  for (const SideIdentification& side : sides) {
    for (const WindowScore& window : side.scores) {
      result.summary += fmt::format("side {}  parameter {:.4g} N/N  {}\n", side.estimate.side,
                                    side.estimate.result.choice.parameter(), window.text());
    }
  }
  return result;
}

void add_wave_based(const Observation& observation, const AssumedModel& model,
                    const ScoreOptions& score, StudyResult& result) {
  require_both_reactions(observation, "the wave-based reconstruction", "wave_based");
  if (!observation.reference) return;
  report::Table table{.id = "wave_based",
                      .title = "Wave-based reconstruction",
                      .caption = "f = 2 Z0 (v1o - v2i) and its mirror, from the two reactions."};
  for (const Method& method : kMethods) {
    const WaveReconstruction wave =
        method.reconstruct(model.basis, model.contact, observation.sample_rate,
                           observation.reaction(End::kLeft)->samples,
                           observation.reaction(End::kRight)->samples, method.outgoing);
    for (const WindowScore& window : scores_of(observation, wave.force, &score).scores) {
      report::add_row(table, [&](ResultVisitor& row) {
        row({.key = "method"}, method.name);
        row({}, window);
      });
      result.summary += fmt::format("waves, {}  {}\n", method.name, window.text());
    }
  }
  result.add({std::move(table)});
}

}  // namespace modcal
