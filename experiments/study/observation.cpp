#include "experiments/study/observation.hpp"

#include "experiments/study/identification.hpp"
#include "libsim/records/told_modes.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

std::shared_ptr<const Truth> simulate_truth(const TruthOptions& options, double sample_rate,
                                            const OutputRequest& outputs, const StopToken& stop) {
  auto truth = std::make_shared<Truth>();
  truth->basis = make_modal_basis(options.scene.string);
  truth->contact = options.scene.bow.position;
  truth->simulation = options.simulator.make()->simulate(options.scene, sample_rate, outputs, stop);
  MODCAL_REQUIRE(!truth->simulation.diverged_at,
                 "the simulation by {} stops at {:g} s: {}; check the values of scene.bow and "
                 "scene.friction, take a shorter simulator.time_step, or another simulator",
                 options.simulator.selected(), *truth->simulation.diverged_at,
                 truth->simulation.explanation);
  return truth;
}

Observation observe_scene(const ObservationOptions& options, OutputRequest outputs,
                          TruthCache& cache, const StreamKey& key) {
  outputs.left_reaction = true;
  outputs.right_reaction = true;
  Observation observation;
  observation.sample_rate = options.measurement.sample_rate;
  observation.truth = cache.get(options.truth, observation.sample_rate, outputs);
  const Truth& truth = *observation.truth;
  observation.basis = truth.basis;
  observation.contact = truth.contact;
  observation.noise_level = options.measurement.noise_level;
  const StreamKey noise = key.with("measurement noise");
  observation.reactions[0] =
      measure(truth.simulation.left_reaction, options.measurement, noise.with("R1"));
  observation.reactions[1] =
      measure(truth.simulation.right_reaction, options.measurement, noise.with("R2"));
  if (outputs.force) observation.reference = truth.simulation.force;
  return observation;
}

// Modes above those stated ring in the record all the same, and what rings is taken for the force.
std::string modes_missing(const StringModel& string, const RecordedSignals& record) {
  std::int64_t told = 0;
  try {
    told = told_modes(string, record).count;
  } catch (const InvalidInput&) {
    return {};  // it tells no number
  }
  if (string.modes >= told) return {};
  return fmt::format(
      "{} modes are stated, but the record tells {}: what the others ring is taken for the force; "
      "state modes: auto, which takes {}",
      string.modes, told, told);
}

Observation observe_record(const ObservationOptions& options, const std::filesystem::path& folder,
                           const StopToken& stop) {
  RecordedSignals record = load_record(options.record, folder, stop);
  Observation observation;
  observation.is_one_signal = record.left && record.right && !require_one_string(options, record);
  observation.sample_rate = record.sample_rate;
  StringModel string = options.string;
  if (string.modes_of_record()) {
    const ToldModes told = told_modes(string, record);
    string.modes = told.count;
    observation.modes_taken = told.text();
  } else {
    observation.modes_missing = modes_missing(string, record);
  }
  observation.basis = make_modal_basis(string);
  observation.contact = options.contact.position;
  observation.reactions[0] = std::move(record.left);
  observation.reactions[1] = std::move(record.right);
  observation.reference = std::move(record.reference);
  observation.reference_velocity = std::move(record.reference_velocity);
  observation.reference_displacement = std::move(record.reference_displacement);
  observation.warnings = std::move(record.warnings);
  if (observation.is_one_signal) {
    observation.warnings.push_back(fmt::format(
        "{}: both reactions are one signal, as a contact in the middle of the string makes them: "
        "they tell nothing of f0, B and x_c, which are taken as stated",
        options.record.file));
  }
  for (auto& reaction : observation.reactions) {
    if (reaction && options.measurement.remove_mean) remove_mean(reaction->samples);
  }
  return observation;
}

// Below the highest mode, where the reactions tell of the force.
void add_anti_aliased(const ObservationOptions& options, TruthCache& cache,
                      std::int64_t oversampling, Observation& observation) {
  const auto step = static_cast<std::size_t>(oversampling);
  const double rate = observation.sample_rate * static_cast<double>(oversampling);
  const auto fine = cache.get(options.truth, rate, {.force = true});
  observation.anti_alias_cut = observation.basis.frequency(observation.basis.size() - 1);
  Signal signal = *observation.reference;
  signal.samples =
      low_passed(fine->simulation.force.samples, rate, observation.anti_alias_cut, step);
  signal.samples.resize(observation.reference->size(), 0.0);
  observation.anti_aliased = std::move(signal);
}

}  // namespace

std::string explain_hidden_modes(const ModalBasis& basis, double sample_rate) {
  const double top = basis.frequency(basis.size() - 1);
  if (top < 0.5 * sample_rate) return {};
  return fmt::format(
      "the highest mode ({:g} Hz) is not below half the sample rate ({:g} Hz): use "
      "fewer modes or a higher rate",
      top, sample_rate);
}

std::string truth_key(TruthOptions options, double sample_rate, const OutputRequest& outputs) {
  return fingerprint([&](OptionVisitor& visitor) {
    options.scene.visit(visitor);
    visitor("simulator", "", options.simulator);
    visitor("sample_rate", "", sample_rate);
    bool flags[] = {outputs.displacement, outputs.velocity, outputs.force, outputs.left_reaction,
                    outputs.right_reaction};
    for (bool& flag : flags) visitor("output", "", flag);
    double switches_from = outputs.switches_from;
    visitor("switches_from", "", switches_from);
  });
}

std::shared_ptr<const Truth> TruthCache::get(const TruthOptions& options, double sample_rate,
                                             const OutputRequest& outputs,
                                             const StopToken::Told& told) {
  return truths_.get(truth_key(options, sample_rate, outputs), [&] {
    return simulate_truth(options, sample_rate, outputs, told ? stop_.telling(told) : stop_);
  });
}

void ModelErrorOptions::visit(OptionVisitor& visitor) {
  visitor("frequencies", "largest relative error of the modal frequencies, drawn for each mode",
          {.range = {0.0, 1.0, true, false}}, frequencies);
  visitor("damping", "relative error of all damping ratios", {.range = Range::at_least(-1.0)},
          damping);
  visitor("contact", "error of the contact point", {.unit = "m"}, contact);
}

AssumedModel with_errors(const ModalBasis& truth, double contact, const ModelErrorOptions& errors,
                         const StreamKey& key) {
  AssumedModel model{truth, contact + errors.contact};
  MODCAL_REQUIRE(model.contact > 0.0 && model.contact < truth.length,
                 "the assumed contact point {:g} m (true {:g} m, error {:g} m) is not inside the "
                 "string of {:g} m",
                 model.contact, contact, errors.contact, truth.length);
  std::vector<double> uniform(truth.size());
  fill_uniform(key, uniform);
  for (std::size_t n = 0; n < truth.size(); ++n) {
    model.basis.omega[n] *= 1.0 + errors.frequencies * (2.0 * uniform[n] - 1.0);
    model.basis.zeta[n] *= 1.0 + errors.damping;
    MODCAL_REQUIRE(model.basis.zeta[n] < 1.0,
                   "damping ratio {:g} of mode {} (error {:g} %) must stay below 1",
                   model.basis.zeta[n], n + 1, 100.0 * errors.damping);
  }
  return model;
}

void ObservationOptions::visit(OptionVisitor& visitor) {
  visitor("scene", "simulated truth: string, bow, friction", has_scene, truth.scene);
  visitor("simulator", "how the scene is simulated", truth.simulator);
  visitor("measurement", "sampling and noise of the simulated reactions", measurement);
  visitor("record", "recorded reactions, in place of a scene", has_record, record);
  visitor("string", "the string of a record", has_string, string);
  visitor("bow", "the bow of a record", has_bow, contact);
}

void ObservationOptions::require_one_source() const {
  MODCAL_REQUIRE(has_scene || has_record,
                 "nothing to invert: state a scene (simulated) or a record (a file)");
  MODCAL_REQUIRE(!(has_scene && has_record), "both a scene and a record are stated: keep one");
  MODCAL_REQUIRE(!has_record || (has_string && has_bow),
                 "a record needs the string that was played (string:) and the contact point "
                 "(bow: {{position: ...}})");
  MODCAL_REQUIRE(!has_scene || (!has_string && !has_bow),
                 "string: and bow: at the top level belong to a record; a scene has its own");
}

std::size_t Observation::samples() const {
  for (const auto& signal : reactions) {
    if (signal) return signal->size();
  }
  return 0;
}

void require_both_reactions(const Observation& observation, std::string_view what,
                            std::string_view option) {
  for (const End end : kEnds) {
    MODCAL_REQUIRE(observation.reaction(end).has_value(),
                   "{} needs both reactions: the one at {} is missing; leave out {} or record it",
                   what, label_of(end), option);
  }
}

std::string_view label_of(End end) { return end == End::kLeft ? "x = 0" : "x = L"; }

Observation observe(const ObservationOptions& options, const OutputRequest& truth_outputs,
                    TruthCache& cache, const StreamKey& key, const std::filesystem::path& folder,
                    std::int64_t oversampling) {
  options.require_one_source();
  Observation observation = options.has_scene ? observe_scene(options, truth_outputs, cache, key)
                                              : observe_record(options, folder, cache.stop());
  observation.fundamental = options.string_model().fundamental;
  const std::string hidden = explain_hidden_modes(observation.basis, observation.sample_rate);
  if (!hidden.empty()) {
    throw WrongKey(options.has_scene ? "scene.string.modes" : "string.modes", hidden);
  }
  if (oversampling > 1 && options.has_scene && observation.reference) {
    add_anti_aliased(options, cache, oversampling, observation);
  }
  return observation;
}

}  // namespace modcal
