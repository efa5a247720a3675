#include <algorithm>

#include "experiments/kinds/invert/invert.hpp"
#include "experiments/kinds/lint.hpp"
#include "experiments/study/fingerprint.hpp"

namespace modcal {
namespace {

// A filter that nothing passes and a rule that chooses nothing, where they are not as they stand in
// every file that a run writes out.
void lint_filter(const InversionOptions& inversion, std::vector<Finding>& findings) {
  const auto text_of = [](auto choice) {
    return fingerprint([&choice](OptionVisitor& visitor) { visitor("", "", choice); });
  };
  const InversionOptions usual;
  const bool states_filter = text_of(inversion.regularizer) != text_of(usual.regularizer);
  const bool states_rule = text_of(inversion.parameter_choice) != text_of(usual.parameter_choice);
  const auto add = [&findings](bool stated, const char* key, std::string text) {
    if (!stated) return;
    findings.push_back({fmt::format("inversion.{}", key), std::move(text), true, true});
  };
  if (!inversion.estimator.make()->filters()) {
    for (const auto& [stated, key] :
         {std::pair(states_filter, "regularizer"), std::pair(states_rule, "parameter_choice")}) {
      add(stated, key,
          fmt::format("estimator {} does not read {}: leave it out, or state estimator: one_sided",
                      inversion.estimator.selected(), key));
    }
  } else if (!inversion.regularizer.make()->has_parameter()) {
    add(states_rule, "parameter_choice",
        fmt::format("regularizer {} has no parameter to choose: leave parameter_choice out, or "
                    "take another regularizer (modcal list regularizer)",
                    inversion.regularizer.selected()));
  }
}

}  // namespace

void lint_sound(std::string path, double sample_rate, std::vector<Finding>& findings) {
  if (!std::isfinite(sample_rate) || sample_rate == std::round(sample_rate)) return;
  add_finding(findings, std::move(path),
              "a sound file cannot hold a sample rate of {} Hz, only whole numbers of hertz: take "
              "the CSV file alone",
              sample_rate);
}

std::vector<Finding> lint_inversion(const InvertOptions& options) {
  std::vector<Finding> findings = lint_observation(options.observation);
  const std::size_t before = findings.size();
  lint_making(findings, "inversion", [&] { InversionRecipe recipe(options.inversion); });
  if (findings.size() == before) lint_filter(options.inversion, findings);
  append(findings, lint_scores(options.score, options.observation));
  if (options.write_sound && options.observation.has_scene) {
    lint_sound("write_sound", options.observation.measurement.sample_rate, findings);
  }
  if (findings.empty() && is_known(options.observation.string_model())) {
    lint_making(findings, "model_error", [&] {
      with_errors(make_modal_basis(options.observation.string_model().before_reading()),
                  options.observation.contact_point(), options.model_error,
                  options.key().with("model error"));
    });
  }
  return findings;
}

FileRead file_read(const RecordOptions& record, std::string key, double numbers_per_sample) {
  const bool present[] = {record.has_left, record.has_right, record.has_reference,
                          record.has_reference_velocity, record.has_reference_displacement};
  const bool is_cropped = record.start > 0.0 || !std::isnan(record.stop);
  return {.name = record.file,
          .key = std::move(key),
          .format = record.format,
          .channels = static_cast<double>(std::ranges::count(present, true)),
          .numbers_per_sample = is_cropped ? 0.0 : numbers_per_sample};
}

}  // namespace modcal
