#include "experiments/kinds/invert/invert_study.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/kinds/invert/model_based_output.hpp"
#include "experiments/kinds/invert/wave_output.hpp"
#include "experiments/study/figures.hpp"

namespace modcal {

void InvertOptions::visit(OptionVisitor& visitor) {
  observation.visit(visitor);
  visitor.section({.key = "model_error", .meaning = "errors put into the model that inverts"},
                  model_error);
  visitor.section({.key = "inversion", .meaning = "how the reactions are inverted"}, inversion);
  visitor.optional_group(
      {.key = "model_based",
       .meaning = "observer with a fitted friction law, beside the linear estimates"},
      has_model_based, [this](OptionVisitor& inner) { model_based.visit(inner); });
  visitor.flag({.key = "wave_based",
                .meaning = "reconstruct the force from the waves of both reactions as well"},
               wave_based);
  visitor.section({.key = "score", .meaning = "where identified and true force are compared"},
                  score);
  visitor.integer(
      {.key = "seed", .meaning = "key of noise and model errors", .range = Range::non_negative()},
      seed);
  visitor.flag({.key = "write_signals", .meaning = "write the identified signals as CSV"},
               write_signals);
  ListOf<FigureOptions> list(figures);
  visitor.list({.key = "figures", .meaning = "what is drawn"}, list);
}

namespace {

bool any_quantity(const std::vector<FigureOptions>& figures, std::string_view quantity) {
  return std::any_of(figures.begin(), figures.end(), [quantity](const FigureOptions& figure) {
    const bool signals = figure.content == "waveforms" || figure.content == "spectra";
    return signals && std::find(figure.quantities.begin(), figure.quantities.end(), quantity) !=
                          figure.quantities.end();
  });
}

report::Cell number_or_none(double value) {
  return std::isnan(value) ? report::Cell() : report::Cell(value);
}

}  // namespace

report::Cell side_cell(const std::string& side) {
  if (side == "1" || side == "2") return side[0] - '0';
  return side;
}

OutputRequest truth_outputs(const std::vector<FigureOptions>& figures) {
  return {.displacement = any_quantity(figures, "y"),
          .velocity = any_quantity(figures, "v"),
          .force = true,
          .left_reaction = true,
          .right_reaction = true};
}

InversionOutputs inversion_outputs(const std::vector<FigureOptions>& figures, bool all) {
  return {.force = true,
          .displacement = all || any_quantity(figures, "y"),
          .velocity = all || any_quantity(figures, "v")};
}

report::Table identification_table(const std::vector<SideIdentification>& sides,
                                   const std::string& command) {
  report::Table table{.id = "identification",
                      .title = "Identification",
                      .columns = {{.key = "side"},
                                  {.key = "parameter", .unit = "N/N"},
                                  {.key = "relative_parameter", .name = "parameter / max|H|"},
                                  {.key = "kept_share", .name = "share of bins kept"},
                                  {.key = "choice", .name = "parameter choice"},
                                  {.key = "window_start", .name = "window from", .unit = "s"},
                                  {.key = "correlation", .name = "correlation R"},
                                  {.key = "relative_rms_error", .name = "relative rms error"},
                                  {.key = "anti_aliased", .name = "R, anti-aliased"},
                                  {.key = "force_deviation",
                                   .name = "standard deviation of the force, posterior",
                                   .unit = "N"}},
                      .command = command};
  for (const SideIdentification& side : sides) {
    const ChosenParameter& choice = side.estimate.result.choice;
    const bool free = choice.status == ChoiceStatus::kNoParameter;
    const std::vector<report::Cell> head = {
        side_cell(side.estimate.side), free ? report::Cell() : report::Cell(choice.parameter()),
        free ? report::Cell() : report::Cell(choice.parameter() / side.estimate.largest_transfer),
        choice.kept_share, std::string(name_of(choice.status))};
    if (side.scores.empty()) {
      std::vector<report::Cell> row = head;
      row.resize(table.columns.size());
      table.rows.push_back(std::move(row));
    }
    for (const WindowScore& score : side.scores) {
      std::vector<report::Cell> row = head;
      row.insert(row.end(), {score.start, score.correlation, score.relative_rms_error,
                             number_or_none(score.anti_aliased),
                             number_or_none(side.estimate.force_deviation)});
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

void add_identification_figures(const std::vector<FigureOptions>& figures,
                                const Observation& observation,
                                const std::vector<SideIdentification>& sides,
                                const std::string& command, StudyResult& result) {
  for (const FigureOptions& options : figures) {
    report::Figure figure;
    if (options.content == "parameter_curves") {
      figure = parameter_curve_figure(options, sides);
    } else if (options.content == "waveforms" || options.content == "spectra") {
      figure = identification_figure(options, observation, sides);
    } else {
      continue;
    }
    figure.command = command;
    result.blocks.emplace_back(std::move(figure));
  }
}

SignalFile identified_signals(const Observation& observation,
                              const std::vector<SideIdentification>& sides) {
  SignalFile file{.name = "identified.csv"};
  for (const SideIdentification& side : sides) {
    const auto add = [&](std::string_view name, std::string_view unit,
                         const std::vector<double>& samples) {
      if (samples.empty()) return;
      const bool numbered = side.estimate.side.size() == 1;
      file.signals.push_back({fmt::format("{}{}{}", name, numbered ? "" : "_", side.estimate.side),
                              std::string(unit), observation.sample_rate, samples});
    };
    add("f_c", "N", side.estimate.result.force);
    add("y", "m", side.estimate.result.displacement);
    add("v", "m/s", side.estimate.result.velocity);
  }
  return file;
}

void add_warnings(const Observation& observation, const std::vector<SideIdentification>& sides,
                  StudyResult& result) {
  for (const std::string& warning : observation.warnings) {
    result.blocks.emplace_back(report::Text{warning, report::Text::Kind::kWarning});
    result.summary += "warning: " + warning + "\n";
  }
  for (const SideIdentification& side : sides) {
    for (const std::string& warning : side.estimate.warnings) {
      const std::string text = fmt::format("Estimate {}: {}", side.estimate.label, warning);
      result.blocks.emplace_back(report::Text{text, report::Text::Kind::kWarning});
      result.summary += "warning: " + text + "\n";
    }
  }
}

StudyResult invert_study(const InvertOptions& options, const StudyContext& context) {
  const StreamKey key = options.key();
  const Observation observation =
      observe(options.observation, truth_outputs(options.figures), context.work.truths, key,
              context.folder, options.score.oversampling);
  const AssumedModel model = with_errors(observation.basis, observation.contact,
                                         options.model_error, key.with("model error"));
  const InversionRecipe recipe(options.inversion);
  const auto estimator = context.work.inversions.get(model, observation, options.inversion, recipe);
  const auto sides =
      identify(observation, *estimator, recipe,
               inversion_outputs(options.figures, options.write_signals), &options.score);

  StudyResult result;
  add_warnings(observation, sides, result);
  add_identification_figures(options.figures, observation, sides, context.command, result);
  result.blocks.emplace_back(identification_table(sides, context.command));
  if (options.write_signals) result.signal_files.push_back(identified_signals(observation, sides));
  if (options.wave_based) {
    add_wave_based(observation, model, options.score, context.command, result);
  }
  if (options.has_model_based) {
    const ModelIdentification by_model =
        identify_by_model(observation, model, options.model_based, &options.score,
                          [&] { return context.stop.requested(); });
    add_model_based(observation, by_model, options.score, context.command, result);
    if (options.write_signals) {
      add_model_signals(observation, by_model, result.signal_files.back());
    }
  }
  for (const SideIdentification& side : sides) {
    for (const WindowScore& score : side.scores) {
      result.summary += fmt::format(
          "side {}  parameter {:.4g} N/N  window from {:g} s: R = {:.4f}, relative rms error "
          "{:.4f}\n",
          side.estimate.side, side.estimate.result.choice.parameter(), score.start,
          score.correlation, score.relative_rms_error);
    }
  }
  return result;
}

}  // namespace modcal
