#include "experiments/kinds/invert/model_based_output.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace modcal {

namespace {

report::Cell number_or_none(double value) {
  return std::isnan(value) ? report::Cell() : report::Cell(value);
}

}  // namespace

report::Table model_score_table(const ModelIdentification& identification,
                                const std::string& command) {
  report::Table table{
      .id = "model_based",
      .title = "Model-based estimate",
      .caption =
          "R and relative rms error of f_c at the samples; anti-aliased: of what is "
          "below the highest mode, not folded back by sampling. Linear: the joint "
          "linear estimate that the observer starts from.",
      .columns = {{.key = "window"},
                  {.key = "R", .format = "{:.4f}"},
                  {.key = "relative_rms_error", .name = "relative rms error"},
                  {.key = "R_anti_aliased", .name = "R, anti-aliased", .format = "{:.4f}"},
                  {.key = "R_linear", .name = "R, linear", .format = "{:.4f}"},
                  {.key = "relative_rms_error_linear", .name = "relative rms error, linear"},
                  {.key = "R_anti_aliased_linear",
                   .name = "R, anti-aliased, linear",
                   .format = "{:.4f}"}},
      .command = command};
  for (const ModelScore& score : identification.scores) {
    std::vector<report::Cell> row = {score.window};
    for (const WindowScore* part : {&score.model, &score.linear}) {
      row.insert(row.end(),
                 {part->correlation, part->relative_rms_error, number_or_none(part->anti_aliased)});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

report::Table model_parameter_table(const ModelIdentification& identification,
                                    const std::string& command) {
  const ModelBasedResult& r = identification.result;
  const observer::ObserverParameters& p = r.parameters;
  const double sign = r.negated ? -1.0 : 1.0;
  report::Table table{.id = "model_parameters",
                      .title = "Fitted model",
                      .columns = {{.key = "quantity"}, {.key = "value"}, {.key = "unit"}},
                      .command = command};
  const auto row = [&](const char* name, double value, const char* unit) {
    table.rows.push_back({name, value, unit});
  };
  row("dynamic friction force", p.sliding.dynamic_force, "N");
  row("static friction force", p.sliding.at_rest(), "N");
  row("decay", p.sliding.decay, "s/m");
  row("bow velocity", sign * p.bow_velocity, "m/s");
  row("adherence stiffness", p.stiffness, "N/m");
  row("adherence damping / critical", p.damping_ratio, "1");
  row("share of the first exponential", p.sliding.weight, "1");
  row("viscous friction", p.sliding.viscous, "N s/m");
  if (p.sliding.thermal) {
    row("heating", p.sliding.heating, "1/J");
    row("cooling", p.sliding.cooling, "1/s");
    row("heat carried away", p.sliding.carried, "1/m");
    row("width of softening", p.sliding.width, "1");
  }
  row("offset at x = 0", sign * p.offset[0], "N");
  row("offset at x = L", sign * p.offset[1], "N");
  row("sensor delay", p.delay, "s");
  row("sensor gain ratio", p.gain, "1");
  row("contact point", p.contact, "m");
  row("noise at x = 0", r.noise[0], "N");
  row("noise at x = L", r.noise[1], "N");
  row("innovation misfit J", r.misfit, "1");
  row("its median over blocks", r.steady_misfit, "1");
  row("of a right model", r.expected_misfit, "1");
  row("standard deviation of the median", r.misfit_deviation, "1");
  row("static level of the force", r.static_part.level, "N");
  row("its standard deviation from the offsets", r.static_part.deviation, "N");
  row("observer runs", static_cast<double>(r.runs), "1");
  return table;
}

report::Table friction_law_table(const ModelIdentification& identification,
                                 const std::string& command) {
  const auto& laws = identification.result.laws;
  report::Table table{
      .id = "friction_laws",
      .title = "Friction laws",
      .caption =
          "BIC over the innovations of both reactions. The first law is named: it has the "
          "fewest parameters of those that the record does not tell from the least "
          "BIC (Vuong's z below 3). Hyperbolic: F_D + drop/(1 + C u). Thermal: F_D + "
          "drop/(1 + exp((T - 1)/width)), T' = heating |f| u - (cooling + carried u) "
          "T, T in units of the softening temperature.",
      .columns = {{.key = "law"},
                  {.key = "bic_difference", .name = "BIC above the least"},
                  {.key = "distance", .name = "Vuong's z to the least BIC"},
                  {.key = "misfit", .name = "J"},
                  {.key = "free_parameters"},
                  {.key = "dynamic_force", .unit = "N"},
                  {.key = "force_drop", .unit = "N"},
                  {.key = "decay", .unit = "s/m"},
                  {.key = "heating", .unit = "1/J"},
                  {.key = "cooling", .unit = "1/s"},
                  {.key = "carried", .unit = "1/m"},
                  {.key = "width"}},
      .command = command};
  double least = std::numeric_limits<double>::infinity();
  for (const observer::FrictionCandidate& law : laws) least = std::min(least, law.criterion);
  for (const observer::FrictionCandidate& law : laws) {
    const observer::BlendedSliding& sliding = law.parameters.sliding;
    std::vector<report::Cell> row = {
        law.law,           law.criterion - least, law.distance,
        law.misfit,        law.free_parameters,   sliding.dynamic_force,
        sliding.force_drop};
    if (!sliding.thermal) row.emplace_back(sliding.decay);
    row.resize(sliding.thermal ? 8 : table.columns.size());
    if (sliding.thermal) {
      row.insert(row.end(), {sliding.heating, sliding.cooling, sliding.carried, sliding.width});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

void add_model_signals(const Observation& observation, const ModelIdentification& identification,
                       SignalFile& file) {
  const ModelBasedResult& r = identification.result;
  file.signals.push_back({"f_c_model", "N", observation.sample_rate, r.force});
  file.signals.push_back({"v_model", "m/s", observation.sample_rate, r.velocity});
  file.signals.push_back({"y_model", "m", observation.sample_rate, r.displacement});
  file.signals.push_back({"f_c_model_deviation", "N", observation.sample_rate, r.force_deviation});
  file.signals.push_back(
      {"v_model_deviation", "m/s", observation.sample_rate, r.velocity_deviation});
}

void add_model_based(const Observation& observation, const ModelIdentification& identification,
                     const ScoreOptions& score, const std::string& command, StudyResult& result) {
  const ModelBasedResult& r = identification.result;
  for (const std::string& warning : r.warnings) {
    const std::string text = "Model-based estimate: " + warning;
    result.blocks.emplace_back(report::Text{text, report::Text::Kind::kWarning});
    result.summary += "warning: " + text + "\n";
  }
  const double length = score.periods / observation.fundamental;
  const double duration = static_cast<double>(r.force.size()) / observation.sample_rate;
  const double start = score.windows.empty() ? 0.5 * duration : score.windows.front();
  result.blocks.emplace_back(
      model_force_figure(observation, identification, start, length, command));
  result.blocks.emplace_back(friction_figure(observation, identification, start, length, command));
  if (r.laws.size() > 1) {
    result.blocks.emplace_back(friction_law_table(identification, command));
    result.summary += fmt::format("model  friction law: {}", r.laws[0].law);
    for (std::size_t i = 1; i < r.laws.size(); ++i) {
      result.summary += fmt::format("{} {} (BIC {:+.4g}, z {:.2g})", i == 1 ? "; others:" : ",",
                                    r.laws[i].law, r.laws[i].criterion - r.laws[0].criterion,
                                    r.laws[i].distance - r.laws[0].distance);
    }
    result.summary += "\n";
  }
  if (!identification.scores.empty()) {
    result.blocks.emplace_back(model_score_table(identification, command));
  }
  result.blocks.emplace_back(model_parameter_table(identification, command));
  for (const ModelScore& window : identification.scores) {
    result.summary +=
        fmt::format("model  J {:.3f}  window {}: R = {:.4f}, relative rms error {:.4f}", r.misfit,
                    window.window, window.model.correlation, window.model.relative_rms_error);
    if (!std::isnan(window.model.anti_aliased)) {
      result.summary += fmt::format(", anti-aliased R = {:.4f}", window.model.anti_aliased);
    }
    result.summary += "\n";
  }
  result.summary +=
      fmt::format("model  static part {:.4g} N, standard deviation from the offsets {:.2g} N\n",
                  r.static_part.level, r.static_part.deviation);
}

}  // namespace modcal
