#include "experiments/kinds/invert/invert.hpp"
#include "experiments/report/result.hpp"
#include "libinverse/observer/model_check.hpp"

namespace modcal {
namespace {

std::vector<ModelScore> model_scores(const ModelBasedResult& result, const Observation& observation,
                                     const ScoreOptions& options) {
  ScoredForce force(result.force);
  force.unaliased = result.unaliased_force;
  const ForceScores model = scores_of(observation, force, &options);
  const ForceScores linear = scores_of(observation, ScoredForce(result.linear.force), &options);
  std::vector<ModelScore> scores;
  for (std::size_t i = 0; i < model.scores.size(); ++i) {
    scores.push_back(
        {fmt::format("{:.4g} s to {:.4g} s", model.scores[i].start, model.scores[i].stop),
         model.scores[i], linear.scores[i]});
  }
  if (!scores.empty() && !options.whole.empty()) {
    scores.push_back({fmt::format("{:g} s to {:g} s", options.whole[0], options.whole[1]),
                      model.whole, linear.whole});
  }
  return scores;
}

report::Table score_table(const std::vector<ModelScore>& scores) {
  return report::table_of(
      {.id = "model_based",
       .title = "Model-based estimate",
       .caption = "R and relative rms error of f_c at the samples; anti-aliased: of what is "
                  "below the highest mode, not folded back by sampling. Linear: the joint "
                  "linear estimate that the observer starts from."},
      scores, [](ResultVisitor& row, const ModelScore& score) {
        row({.key = "window"}, score.window);
        row({.key = "R", .format = "{:.4f}"}, score.model.correlation);
        row({.key = "relative_rms_error", .name = "relative rms error"},
            score.model.relative_rms_error);
        row({.key = "R_anti_aliased", .name = "R, anti-aliased", .format = "{:.4f}"},
            known(score.model.anti_aliased));
        row({.key = "R_linear", .name = "R, linear", .format = "{:.4f}"}, score.linear.correlation);
        row({.key = "relative_rms_error_linear", .name = "relative rms error, linear"},
            score.linear.relative_rms_error);
        row({.key = "R_anti_aliased_linear", .name = "R, anti-aliased, linear", .format = "{:.4f}"},
            known(score.linear.anti_aliased));
      });
}

report::Table parameter_table(const ModelBasedResult& r) {
  const observer::ObserverParameters& p = r.parameters;
  const double sign = r.negated ? -1.0 : 1.0;
  report::Table table{.id = "model_parameters",
                      .title = "Fitted model",
                      .columns = {{.key = "quantity"}, {.key = "value"}, {.key = "unit"}}};
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

report::Table law_table(const std::vector<observer::FrictionCandidate>& laws) {
  double least = std::numeric_limits<double>::infinity();
  for (const observer::FrictionCandidate& law : laws) least = std::min(least, law.criterion);
  return report::table_of(
      {.id = "friction_laws",
       .title = "Friction laws",
       .caption = "BIC over the innovations of both reactions. The first law is named: it has the "
                  "fewest parameters of those that the record does not tell from the least "
                  "BIC (Vuong's z below 3). Hyperbolic: F_D + drop/(1 + C u). Thermal: F_D + "
                  "drop/(1 + exp((T - 1)/width)), T' = heating |f| u - (cooling + carried u) "
                  "T, T in units of the softening temperature."},
      laws, [least](ResultVisitor& row, const observer::FrictionCandidate& law) {
        const observer::BlendedSliding& sliding = law.parameters.sliding;
        const auto where = [](bool shown, double value) {
          return shown ? std::optional(value) : std::nullopt;
        };
        const bool thermal = sliding.thermal;
        row({.key = "law"}, law.law);
        row({.key = "bic_difference", .name = "BIC above the least"}, law.criterion - least);
        row({.key = "distance", .name = "Vuong's z to the least BIC"}, law.distance);
        row({.key = "misfit", .name = "J"}, law.misfit);
        row({.key = "free_parameters"}, law.free_parameters);
        row({.key = "dynamic_force", .unit = "N"}, sliding.dynamic_force);
        row({.key = "force_drop", .unit = "N"}, sliding.force_drop);
        row({.key = "decay", .unit = "s/m"}, where(!thermal, sliding.decay));
        row({.key = "heating", .unit = "1/J"}, where(thermal, sliding.heating));
        row({.key = "cooling", .unit = "1/s"}, where(thermal, sliding.cooling));
        row({.key = "carried", .unit = "1/m"}, where(thermal, sliding.carried));
        row({.key = "width"}, where(thermal, sliding.width));
      });
}

}  // namespace

ModelIdentification identify_by_model(const Observation& observation, const AssumedModel& model,
                                      const ModelBasedOptions& options, const ScoreOptions& score,
                                      const StopToken& stop) {
  require_both_reactions(observation, "the model-based estimate", "model_based");
  ModelIdentification identification;
  identification.result = ModelBasedEstimator(options).estimate(
      model.basis, model.contact, observation.sample_rate,
      observation.reaction(End::kLeft)->samples, observation.reaction(End::kRight)->samples, stop,
      observation.truth == nullptr);
  identification.scores = model_scores(identification.result, observation, score);
  return identification;
}

void add_model_signals(const Observation& observation, const ModelBasedResult& model,
                       SignalFile& file) {
  const auto add = [&](const char* name, const char* unit, const std::vector<double>& samples) {
    file.signals.push_back({name, unit, observation.sample_rate, samples});
  };
  add("f_c_model", "N", model.force);
  add("f_c_model_unaliased", "N", model.unaliased_force);
  add("v_model", "m/s", model.velocity);
  add("y_model", "m", model.displacement);
  add("f_c_model_deviation", "N", model.deviation.force);
  add("v_model_deviation", "m/s", model.deviation.velocity);
}

void add_model_based(const Observation& observation, const ModelIdentification& identification,
                     const ScoreOptions& score, StudyResult& result) {
  const ModelBasedResult& r = identification.result;
  for (const std::string& warning : r.warnings) result.warn("Model-based estimate: " + warning);
  const double duration = static_cast<double>(r.force.size()) / observation.sample_rate;
  const double start = score.windows.empty() ? 0.5 * duration : score.windows.front();
  const double length = score.periods / observation.fundamental;
  result.blocks.emplace_back(model_force_figure(observation, r, start, length));
  result.blocks.emplace_back(friction_figure(observation, r, start, length));
  if (r.laws.size() > 1) {
    result.add({law_table(r.laws)});
    result.summary += fmt::format("model  {}\n", observer::law_note(r));
  }
  if (!identification.scores.empty()) result.add({score_table(identification.scores)});
  result.add({parameter_table(r)});
  for (const ModelScore& window_score : identification.scores) {
    const WindowScore& model = window_score.model;
    result.summary +=
        fmt::format("model  J {:.3f}  window {}: R = {:.4f}, relative rms error {:.4f}", r.misfit,
                    window_score.window, model.correlation, model.relative_rms_error);
    if (!std::isnan(model.anti_aliased)) {
      result.summary += fmt::format(", anti-aliased R = {:.4f}", model.anti_aliased);
    }
    result.summary += "\n";
  }
  result.summary +=
      fmt::format("model  static part {:.4g} N, standard deviation from the offsets {:.2g} N\n",
                  r.static_part.level, r.static_part.deviation);
}

}  // namespace modcal
