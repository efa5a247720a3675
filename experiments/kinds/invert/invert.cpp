#include "experiments/kinds/invert/invert.hpp"

#include "experiments/kinds/lint.hpp"
#include "experiments/report/result.hpp"
#include "experiments/study/observation.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
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
  visitor("write_signals", "write force, displacement and velocity at the contact as CSV",
          write_signals);
  visitor("write_sound", "write them as a sound file as well, identified.wav: 1.0 is one SI unit",
          write_sound);
  visitor("overview", "draw force, motion, spectra and misfit, beside the figures asked for",
          overview);
  visitor("figures", "what is drawn beside", figures);
}

std::vector<Finding> InvertOptions::lint() const {
  std::vector<Finding> findings = lint_inversion(*this);
  append(findings,
         lint_figures(figures, FigureContent::kParameterCurves, stated_duration(observation)));
  return findings;
}

void lint_windows(const InvertOptions& options, const Observation& observation,
                  std::vector<Finding>& findings) {
  const std::vector<double> silence(observation.samples());
  lint_making(findings, "score", [&] {
    scores_of(observation, ScoredForce(silence), &options.score);
    const Estimate still{.result = {.displacement = silence, .velocity = silence}};
    motion_scores(observation, still, options.score);
  });
  const double duration = static_cast<double>(observation.samples()) / observation.sample_rate;
  append(findings, lint_figure_windows(options.figures, duration));
  if (options.write_sound) lint_sound("write_sound", observation.sample_rate, findings);
}

std::vector<Finding> InvertOptions::lint_records(const std::filesystem::path& folder) const {
  std::vector<Finding> findings;
  const auto observed = lint_record("record.file", observation, folder, findings);
  if (!observed) return findings;
  lint_modes(*observed, findings);
  lint_making(findings, "string.fundamental",
              [&] { require_told_fundamental(observation, *observed); });
  lint_windows(*this, *observed, findings);
  return findings;
}

std::vector<FileRead> InvertOptions::files_read() const {
  if (!observation.has_record) return {};
  return {file_read(observation.record, "record.file",
                    inversion.estimator.make()->numbers_per_sample())};
}

std::vector<PlanLine> InvertOptions::plan() const {
  std::vector<PlanLine> lines = {source_line(planned_simulations(), observation)};
  const InversionOutputs outputs = inversion_outputs(figures, wants_all());
  const auto skip = [&lines](bool wanted, const char* what) {
    if (wanted) return;
    lines.push_back({fmt::format("skipped: identified {}, which nobody reads", what),
                     {{"skipped", nlohmann::ordered_json::array({what})}}});
  };
  skip(outputs.displacement, "displacement");
  skip(outputs.velocity, "velocity");
  return lines;
}

std::optional<PlannedSimulations> InvertOptions::planned_simulations() const {
  auto planned = planned_truths(observation, truth_outputs(figures, overview));
  if (planned) planned->numbers_per_sample = inversion.estimator.make()->numbers_per_sample();
  return planned;
}

OutputRequest truth_outputs(const std::vector<FigureOptions>& figures, bool all) {
  OutputRequest request{.displacement = all,
                        .velocity = all,
                        .force = true,
                        .left_reaction = true,
                        .right_reaction = true};
  for (const FigureOptions& figure : figures) {
    if (!figure.draws_signals()) continue;
    for (const std::string& name : figure.quantities) request.*quantity_of(name).wanted = true;
  }
  return request;
}

InversionOutputs inversion_outputs(const std::vector<FigureOptions>& figures, bool all) {
  const OutputRequest drawn = truth_outputs(figures);
  return {.force = true,
          .displacement = all || drawn.displacement,
          .velocity = all || drawn.velocity,
          .side_misfit = all};
}

void InvertOptions::add_signals(const SignalFile& signals, StudyResult& result) const {
  for (const auto& [wanted, extension] :
       {std::pair(write_signals, ".csv"), {write_sound, ".wav"}}) {
    if (!wanted) continue;
    result.signal_files.push_back(signals);
    result.signal_files.back().name += extension;
  }
}

InvertOptions InvertOptions::as_read_by(const StudyContext& context) const {
  InvertOptions options = *this;
  if (!context.numbers_alone) return options;
  options.write_signals = options.write_sound = options.overview = false;
  options.figures.clear();
  return options;
}

void add_identification_figures(const std::vector<FigureOptions>& figures,
                                const Observation& observation,
                                const std::vector<SideIdentification>& sides, StudyResult& result) {
  for (const FigureOptions& figure : figures) {
    if (figure.draws_search()) continue;
    result.blocks.emplace_back(identification_figure(figure, observation, sides));
  }
}

SignalFile identified_signals(const Observation& observation,
                              const std::vector<SideIdentification>& sides) {
  SignalFile file{.name = "identified"};
  for (const SideIdentification& side : sides) {
    const Estimate& estimate = side.estimate;
    if (std::string note = band_note(estimate); !note.empty())
      file.notes.push_back(std::move(note));
    const bool numbered = estimate.side.size() == 1;
    const auto add = [&](std::string name, std::string_view unit, std::vector<double> samples) {
      if (samples.empty()) return;
      file.signals.push_back(
          {std::move(name), std::string(unit), observation.sample_rate, std::move(samples)});
    };
    for (const Quantity& quantity : kQuantities) {
      if (quantity.identified == nullptr) continue;
      const std::string column =
          fmt::format("{}{}{}", quantity.name, numbered ? "" : "_", estimate.side);
      add(column, quantity.unit, estimate.result.*quantity.identified);
      if (quantity.unaliased != nullptr) {
        add(column + "_unaliased", quantity.unit, estimate.*quantity.unaliased);
      }
      std::vector<double> deviations(observation.samples());
      for (std::size_t j = 0; j < deviations.size(); ++j) {
        deviations[j] = quantity.deviation_at(estimate, j);
      }
      if (!std::isnan(deviations.front())) {
        add(column + "_deviation", quantity.unit, std::move(deviations));
      }
    }
  }
  return file;
}

// What to try against what an estimate warns of.
std::vector<std::string> remedies_of(const SideIdentification& side, bool is_recorded,
                                     bool is_calibrated) {
  std::vector<std::string> remedies;
  if (side.estimate.warnings.empty()) return remedies;
  const std::vector<double>& misfit = side.estimate.side_misfit;
  const bool contradicted = !misfit.empty() && mean(misfit) > 1.0;
  if (contradicted && is_recorded) {
    if (!is_calibrated) remedies.emplace_back("calibrate the string first (kind: calibrate)");
    remedies.emplace_back(
        "check the gains of both sensors (record.left.calibration, record.right.calibration)");
    remedies.emplace_back("use another part of the record (record.start, record.stop)");
  } else if (contradicted) {
    remedies.emplace_back("a longer scene.duration, or a smaller model_error");
  }
  switch (side.estimate.result.choice.status) {
    case ChoiceStatus::kNoInteriorMinimum:
    case ChoiceStatus::kEdgeOfRange:
    case ChoiceStatus::kNotReached:
    case ChoiceStatus::kNotComputed:
      remedies.emplace_back(
          "choose the parameter by another rule (inversion.parameter_choice, modcal list "
          "parameter_choice), or identify from both reactions (inversion.estimator: joint)");
      break;
    default:
      break;
  }
  return remedies;
}

void add_warnings(const Observation& observation, const std::vector<SideIdentification>& sides,
                  bool is_calibrated, StudyResult& result) {
  for (const std::string& warning : observation.warnings) result.warn(warning);
  if (!observation.modes_missing.empty()) result.warn(observation.modes_missing);
  std::vector<std::string> remedies;
  for (const SideIdentification& side : sides) {
    for (const std::string& warning : side.estimate.warnings) {
      result.warn(fmt::format("Estimate {}: {}", side.estimate.label, warning));
    }
    for (std::string& remedy : remedies_of(side, !observation.truth, is_calibrated)) {
      if (std::ranges::find(remedies, remedy) == remedies.end()) {
        remedies.push_back(std::move(remedy));
      }
    }
  }
  if (remedies.empty()) return;
  for (const std::string& remedy : remedies) result.summary += fmt::format("to try: {}\n", remedy);
  result.blocks.emplace_back(report::Text{fmt::format("To try: {}.", fmt::join(remedies, "; ")),
                                          report::Text::Kind::kNote});
}

void add_notes(const Observation& observation, const std::vector<SideIdentification>& sides,
               StudyResult& result) {
  const auto note = [&result](const std::string& text) {
    result.blocks.emplace_back(report::Text{text, report::Text::Kind::kNote});
  };
  if (!observation.modes_taken.empty()) {
    result.summary += observation.modes_taken + "\n";
    note(observation.modes_taken);
  }
  for (const SideIdentification& side : sides) {
    for (const std::string& text : side.estimate.notes) {
      result.summary += fmt::format("side {}  {}\n", side.estimate.side, text);
      note(text);
    }
  }
}

namespace {

// How good the identified force is, in a sentence.
std::string answer_of(const std::vector<SideIdentification>& sides) {
  std::string answer;
  for (const SideIdentification& side : sides) {
    const Estimate& estimate = side.estimate;
    answer += fmt::format("{} {}", answer.empty() ? "Force" : ";", estimate.label);
    if (!side.scores.empty()) {
      answer += ", " + side.scores.front().text();
    } else if (!std::isnan(estimate.force_deviation)) {
      answer += fmt::format(", standard deviation {:.3g} N", estimate.force_deviation);
      if (std::isfinite(estimate.band_limit)) {
        answer += fmt::format(" of what lies below {:.4g} kHz", 1e-3 * estimate.band_limit);
      }
    } else {
      answer += ": neither a band nor a measured force to hold it against";
    }
    if (!estimate.warnings.empty()) answer += ", doubtful (see the warning)";
  }
  return answer;
}

}  // namespace

StudyResult InvertOptions::run(const StudyContext& context) const {
  const InvertOptions shown = as_read_by(context);
  const Observation observed =
      observe(observation, truth_outputs(shown.figures, shown.overview), context.work.truths, key(),
              context.folder, score.oversampling);
  require_told_fundamental(observation, observed);
  const AssumedModel model =
      with_errors(observed.basis, observed.contact, model_error, key().with("model error"));
  const auto sides =
      identify(observed, model, inversion, inversion_outputs(shown.figures, shown.wants_all()),
               &score, &context.work.inversions);

  StudyResult result;
  result.answer = answer_of(sides);
  add_warnings(observed, sides, false, result);
  std::vector<report::Figure> drawn;
  if (shown.overview) drawn = overview_figures(observed, sides);
  // The force and what the reactions contradict each other by; else what was asked for.
  const auto first = drawn.begin() + std::min<std::ptrdiff_t>(2, std::ssize(drawn));
  std::move(drawn.begin(), first, std::back_inserter(result.blocks));
  if (drawn.empty()) add_identification_figures(shown.figures, observed, sides, result);
  add_identification_tables(sides, result);
  result.end_first_screen();
  add_notes(observed, sides, result);
  std::move(first, drawn.end(), std::back_inserter(result.blocks));
  if (!drawn.empty()) add_identification_figures(shown.figures, observed, sides, result);
  SignalFile signals;
  if (shown.writes()) signals = identified_signals(observed, sides);
  if (wave_based) add_wave_based(observed, model, score, result);
  if (has_model_based) {
    const ModelIdentification by_model =
        identify_by_model(observed, model, model_based, score, context.stop);
    add_model_based(observed, by_model, score, result);
    if (shown.writes()) add_model_signals(observed, by_model.result, signals);
  }
  shown.add_signals(signals, result);
  add_scores(sides, result);
  return result;
}

}  // namespace modcal
