#include "experiments/kinds/lint.hpp"

#include <algorithm>

#include "experiments/kinds/lint_bow.hpp"

namespace modcal {

bool is_known(const StringModel& string) {
  return std::isfinite(string.length) && std::isfinite(string.linear_density) &&
         std::isfinite(string.fundamental);
}

namespace {

// Transverse waves of a string run at the root of its stress over its density: 650 m/s at the
// strength of the best steel wire, and no string that sounds is slower than 1 m/s. The tensions of
// musical strings are 10 N to 1 kN; a density in another unit is off by a thousand.
void lint_waves(const std::string& path, const StringModel& string,
                std::vector<Finding>& findings) {
  constexpr double kSlowest = 1.0, kFastest = 5000.0;  // [m/s]
  constexpr double kSlackest = 0.1, kTautest = 2e4;    // [N]
  if (!is_known(string)) return;
  const double speed = 2.0 * string.length * string.fundamental;
  const double tension = string.linear_density * speed * speed;
  if (speed < kSlowest || speed > kFastest) {
    findings.push_back(
        {path + ".length",
         fmt::format("length {:g} m and fundamental {:g} Hz make waves of {:.3g} m/s, which no "
                     "string carries: check the units, a bare number is in m or Hz",
                     string.length, string.fundamental, speed),
         false});
  } else if (tension < kSlackest || tension > kTautest) {
    findings.push_back(
        {path + ".linear_density",
         fmt::format("linear_density {:g} kg/m and waves of {:.3g} m/s make a tension of {:.3g} N, "
                     "which no string has: check the units, a bare number is in kg/m",
                     string.linear_density, speed, tension),
         false});
  }
}

// Of the reactions' own level.
void lint_noise_level(double level, std::vector<Finding>& findings) {
  constexpr double kLoudest = 0.5;
  if (!(level >= kLoudest)) return;
  findings.push_back(
      {"measurement.noise_level",
       fmt::format("noise of {:g} % of what the sensors read hides the string: check "
                   "the unit, a bare number is a share and 1 % is 0.01",
                   100.0 * level),
       false});
}

void lint_string(const std::string& path, const StringModel& string, double position,
                 const std::string& bow_path, std::vector<Finding>& findings) {
  if (!is_known(string)) return;
  if (position >= string.length) {
    add_finding(findings, bow_path + ".position",
                "contact point {:g} m is outside the string of {:g} m: it must "
                "lie between its ends",
                position, string.length);
  }
  // Of what is made of parts the first place is that of the part.
  lint_making(findings, path + ".damping", [&] { string.damping.make(); });
  lint_making(findings, string.modes_of_record() ? path + ".modes" : path,
              [&] { make_modal_basis(string); });
}

void lint_rate(const StringModel& string, double sample_rate, const std::string& string_path,
               std::vector<Finding>& findings) {
  const auto frequency = [&string](std::size_t n) {
    return stiff_string_frequency(string.fundamental, string.inharmonicity, n);
  };
  auto most = static_cast<std::size_t>(string.modes);
  const double top = frequency(most), half = 0.5 * sample_rate;
  if (!std::isfinite(top) || top < half) return;
  while (most > 0 && !(frequency(most) < half)) --most;
  if (most == 0)
    return add_finding(findings, "measurement.sample_rate",
                       "{:.6g} Hz show no string of {:.6g} Hz: check the unit", sample_rate,
                       frequency(1));
  add_finding(findings, string_path + ".modes",
              "mode {} at {:.6g} Hz is not below half the sample rate, {:.6g} Hz: use at most "
              "{} modes or a higher measurement.sample_rate",
              string.modes, top, half, most);
}

// What the simulator refuses for its kind alone.
void lint_fit(const Scene& scene, const Choice<Simulator>& simulator,
              std::vector<Finding>& findings) {
  for (const SceneRefusal& refusal : simulator.make()->refusals(scene)) {
    add_finding(findings, "scene." + refusal.key, "{}", refusal.reason);
  }
}

// What a simulator refuses once it has made two of its steps, however many a sample takes.
void lint_step(const Scene& scene, const Choice<Simulator>& simulator, double sample_rate,
               std::vector<Finding>& findings) {
  const auto made = simulator.make();
  const double step = made->longest_step();
  if (!is_known(scene.string) || !std::isfinite(step)) return;
  const double rate = 1.0 / plan_steps(step, sample_rate).time_step;
  const std::size_t before = findings.size();
  Scene begin = scene;
  begin.duration = std::min(scene.duration, 2.0 / rate);
  lint_making(findings, "simulator.time_step", [&] { made->simulate(begin, rate, {}); });
  // Rounding apart; a step that nobody has stated is cut without a word.
  const double usual = Choice<Simulator>(simulator.selected()).make()->longest_step();
  if (findings.size() > before || step == usual || !(step > (1.0 + 1e-9) / sample_rate)) return;
  findings.push_back({"simulator.time_step",
                      fmt::format("time_step {:g} s is longer than the {:.4g} s from one sample "
                                  "to the next, which is the step then: state that or less",
                                  step, 1.0 / sample_rate),
                      false});
}

void lint_decay(const Scene& scene, std::vector<Finding>& findings) {
  if (!is_known(scene.string)) return;
  std::vector<double> zeta;
  try {
    zeta = make_modal_basis(scene.string).zeta;
  } catch (const InvalidInput&) {
    return;  // reported with the string
  }
  const double decay_time = 1.0 / (2.0 * std::numbers::pi * scene.string.fundamental * zeta[0]);
  if (scene.duration >= 0.5 * decay_time) return;
  findings.push_back(
      {"scene.duration",
       fmt::format("the record of {:g} s is short against the decay time of the first mode, {:.3g} "
                   "s: its transform wraps what still rings at the end",
                   scene.duration, decay_time),
       false});
}

}  // namespace

void refuse_beside_structure(std::initializer_list<StatedKey> keys,
                             std::vector<Finding>& findings) {
  for (const auto& [key, stated] : keys) {
    if (!stated) continue;
    add_finding(findings, key,
                "{} is for a string and would do nothing beside structure: leave one of both out",
                key);
  }
}

void append(std::vector<Finding>& all, std::vector<Finding> more) {
  all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

std::vector<Finding> lint_scene(const Scene& scene, const Choice<Simulator>& simulator,
                                const Measurement& measurement) {
  std::vector<Finding> findings;
  lint_string("scene.string", scene.string, scene.bow.position, "scene.bow", findings);
  if (is_known(scene.string) && findings.empty()) {
    lint_making(findings, "scene.initial",
                [&] { initial_state(scene, make_modal_basis(scene.string)); });
  }
  lint_bow("scene.bow", scene.bow, scene.duration, findings);
  lint_rate(scene.string, measurement.sample_rate, "scene.string", findings);
  const std::size_t before = findings.size();
  lint_making(findings, "scene.friction", [&] { scene.friction.make(); });
  lint_making(findings, "simulator", [&] { simulator.make(); });
  if (findings.size() == before) lint_fit(scene, simulator, findings);
  lint_making(findings, "scene.duration",
              [&] { sample_count(scene.duration, measurement.sample_rate); });
  if (findings.size() == before) lint_step(scene, simulator, measurement.sample_rate, findings);
  lint_waves("scene.string", scene.string, findings);
  lint_noise_level(measurement.noise_level, findings);
  return findings;
}

namespace {

// What a record does not read, where it is not as it stands in every file that a run writes out.
void lint_unread(const ObservationOptions& options, std::vector<Finding>& findings) {
  const Measurement usual;
  const auto simulator_of = [](const TruthOptions& truth) {
    return fingerprint([simulator = truth.simulator](OptionVisitor& visitor) mutable {
      visitor("", "", simulator);
    });
  };
  const auto refuse = [&findings](bool stated, const char* key) {
    if (!stated) return;
    add_finding(findings, key,
                "a record is not simulated and does not read {}: leave it out, or state a scene in "
                "the place of the record",
                key);
  };
  refuse(options.measurement.sample_rate != usual.sample_rate, "measurement.sample_rate");
  refuse(options.measurement.noise_level != usual.noise_level, "measurement.noise_level");
  refuse(simulator_of(options.truth) != simulator_of(TruthOptions()), "simulator");
}

}  // namespace

std::vector<Finding> lint_observation(const ObservationOptions& options) {
  std::vector<Finding> findings;
  lint_making(findings, options.has_record ? "record" : "scene",
              [&] { options.require_one_source(); });
  if (!findings.empty()) return findings;
  if (options.has_scene) {
    findings = lint_scene(options.truth.scene, options.truth.simulator, options.measurement);
    lint_decay(options.truth.scene, findings);
    return findings;
  }
  lint_unread(options, findings);
  lint_string("string", options.string.before_reading(), options.contact.position, "bow", findings);
  lint_waves("string", options.string, findings);
  return findings;
}

std::optional<Observation> lint_record(const std::string& path, const ObservationOptions& options,
                                       const std::filesystem::path& folder,
                                       std::vector<Finding>& findings) {
  std::optional<Observation> observation;
  if (!options.has_record) return observation;
  // Keys that a file does not bear stand beside its name, where it has a section of its own.
  constexpr std::string_view kFile = ".file";
  std::string place = path;
  lint_making(findings, path, [&] {
    TruthCache none;
    try {
      observation = observe(options, {}, none, StreamKey(0), folder);
    } catch (const WrongRecordKey& error) {
      if (path.ends_with(kFile)) {
        place.replace(path.size() - kFile.size() + 1, std::string::npos, error.key());
      }
      throw WrongKey(place, error.what());
    }
  });
  if (observation) {
    for (const std::string& warning : observation->warnings) {
      findings.push_back({path, warning, false});
    }
  }
  return observation;
}

void lint_modes(const Observation& observation, std::vector<Finding>& findings) {
  if (observation.modes_missing.empty()) return;
  findings.push_back({"string.modes", observation.modes_missing, false});
}

std::vector<Finding> lint_scores(const ScoreOptions& score, const ObservationOptions& options) {
  std::vector<Finding> findings;
  const RecordOptions& record = options.record;
  const bool has_reference =
      record.has_reference || record.has_reference_velocity || record.has_reference_displacement;
  if (!options.has_scene && options.has_record && !has_reference &&
      !(score.windows.empty() && score.whole.empty())) {
    add_finding(findings, "score",
                "nothing is scored: the record has no measured force; name its channel "
                "(record.reference), or leave score out");
  }
  if (!options.has_scene || !is_known(options.truth.scene.string)) return findings;
  const double duration = options.truth.scene.duration;
  const double length = score.periods / options.truth.scene.string.fundamental;
  for (const double start : score.windows) {
    if (start + length <= duration) continue;
    add_finding(findings, "score.windows",
                "the window from {:g} s over {:g} periods ends at {:.4g} s, "
                "after the record of {:g} s",
                start, score.periods, start + length, duration);
  }
  return findings;
}

}  // namespace modcal
