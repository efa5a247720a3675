// Physics lint: what no single option shows.
#pragma once

#include "experiments/experiment.hpp"
#include "experiments/study/figures.hpp"
#include "libcalib/parameters/string_unknowns.hpp"

namespace modcal {

/// Whether the numbers that a string needs have been read: nothing follows from wrong ones.
bool is_known(const StringModel& string);

/// Nyquist against the highest mode, contact inside the string, what the scene's parts refuse.
std::vector<Finding> lint_scene(const Scene& scene, const Choice<Simulator>& simulator,
                                const Measurement& measurement);
/// The same for what an experiment inverts; record length against the decay; that exactly one
/// source is stated.
std::vector<Finding> lint_observation(const ObservationOptions& options);
/// A finding at `path` where a recorded observation cannot be made of its file; what it is, else.
/// Nothing of a scene.
std::optional<Observation> lint_record(const std::string& path, const ObservationOptions& options,
                                       const std::filesystem::path& folder,
                                       std::vector<Finding>& findings);
/// A warning where fewer modes are stated than the record tells.
void lint_modes(const Observation& observation, std::vector<Finding>& findings);
/// Score windows inside the record.
std::vector<Finding> lint_scores(const ScoreOptions& score, const ObservationOptions& options);
/// Of the record of a scene; NaN where it is not known before the record is read.
inline double stated_duration(const ObservationOptions& options) {
  return options.has_scene ? options.truth.scene.duration
                           : std::numeric_limits<double>::quiet_NaN();
}
/// Windows of figures that hold nothing of a record of `duration`, each at its own place.
std::vector<Finding> lint_figure_windows(const std::vector<FigureOptions>& figures,
                                         double duration);
/// Ids used twice, contents after the `last` that this kind of experiment has; windows, unless the
/// duration is NaN: not known before the record is read.
std::vector<Finding> lint_figures(const std::vector<FigureOptions>& figures, FigureContent last,
                                  double duration);
/// What require_priors() has against each fixed parameter, prior and correlation, at its own place.
/// path: of the unknowns.
std::vector<Finding> lint_priors(const std::string& path, const UnknownsOptions& unknowns,
                                 const StringModel& string, std::size_t records = 1);
/// An error at `path`.
template <typename... Args>
void add_finding(std::vector<Finding>& findings, std::string path, fmt::format_string<Args...> text,
                 Args&&... args) {
  findings.push_back({std::move(path), fmt::format(text, std::forward<Args>(args)...)});
}
/// A finding at `path` where `make` throws InvalidInput; at its own where that names a key.
template <typename Make>
void lint_making(std::vector<Finding>& findings, const std::string& path, Make make) {
  try {
    make();
  } catch (const WrongKey& error) {
    findings.push_back({error.path(), error.what()});
  } catch (const InvalidInput& error) {
    findings.push_back({path, error.what()});
  }
}
/// Whether two sets of options say the same.
template <typename Options>
bool same_options(Options a, Options b) {
  const auto text = [](Options& options) {
    return fingerprint([&](OptionVisitor& visitor) { options.visit(visitor); });
  };
  return text(a) == text(b);
}
/// Keys of a string that are stated beside `structure:`, where they would do nothing.
struct StatedKey {
  const char* key;
  bool stated;
};
void refuse_beside_structure(std::initializer_list<StatedKey> keys, std::vector<Finding>& findings);
/// A sound file has a whole number of hertz.
void lint_sound(std::string path, double sample_rate, std::vector<Finding>& findings);
void append(std::vector<Finding>& all, std::vector<Finding> more);

/// Text that is equal for simulations with equal signals.
std::string key_of(const PlannedSimulations& planned);
/// How many simulations of how many samples, others of the run behind them.
PlanLine plan_line(const PlannedSimulations& planned);
/// What a record that is read, or a simulation, has to say of itself.
PlanLine source_line(const std::optional<PlannedSimulations>& planned,
                     const ObservationOptions& observation);

/// The truth that a run simulates for inversions; nothing for a record.
std::optional<PlannedSimulations> planned_truths(const ObservationOptions& observation,
                                                 OutputRequest outputs, std::size_t count = 1);

/// Adds a simulation of another scene, once.
void add_planned(const ObservationOptions& observation, PlannedSimulations& planned);

}  // namespace modcal
