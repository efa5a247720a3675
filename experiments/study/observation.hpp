// What an experiment inverts: a simulated or a recorded pair of reactions, the truth behind it,
// computed once per distinct scene and shared by a whole sweep, and the model it starts from.
#pragma once

#include <optional>

#include "experiments/study/fingerprint.hpp"
#include "libinverse/waves/end_relation.hpp"
#include "libsim/dynamics/scene/simulator.hpp"
#include "libsim/model/transfer.hpp"
#include "libsim/records/recording.hpp"
#include "libsim/signal/measurement.hpp"

namespace modcal {

/// A simulated record with the model that made it.
struct Truth {
  ModalBasis basis;
  double contact = 0.0;  ///< x_c [m]
  Simulation simulation;
};

/// Scene and simulator as an experiment states them.
struct TruthOptions {
  Scene scene;
  Choice<Simulator> simulator{"newmark_explicit"};
};

/// Equal for equal truths: scene, simulator, rate and outputs, bit for bit.
std::string truth_key(TruthOptions options, double sample_rate, const OutputRequest& outputs);

/// Simulates, or waits for the thread that is simulating the same truth.
class TruthCache {
 public:
  TruthCache() = default;
  explicit TruthCache(const StopToken& stop) : stop_(stop) {}
  /// Throws InvalidInput where the scene cannot be simulated or the simulation diverges,
  /// Interrupted where the stop was requested. `told`: gets the share of a new simulation done.
  std::shared_ptr<const Truth> get(const TruthOptions& options, double sample_rate,
                                   const OutputRequest& outputs, const StopToken::Told& told = {});
  /// Simulations done so far.
  std::size_t simulated() const { return truths_.size(); }
  const StopToken& stop() const { return stop_; }

 private:
  StopToken stop_;
  ComputedOnce<std::shared_ptr<const Truth>> truths_;
};

/// Largest relative error of the modal frequencies (uniform, independent in every mode, both
/// signs), relative error of all damping ratios, and error of the contact point [m].
struct ModelErrorOptions {
  double frequencies = 0.0;
  double damping = 0.0;
  double contact = 0.0;
  void visit(OptionVisitor& visitor);
};

/// The model an inversion starts from.
struct AssumedModel {
  ModalBasis basis;
  double contact = 0.0;              ///< x_c [m]
  std::optional<bool> bending = {};  ///< whether the ends feel it, where that is stated
};

/// The true model with the stated errors; those of the frequencies are drawn from `key`.
/// Throws InvalidInput where the contact point leaves the string or a damping ratio leaves [0, 1).
AssumedModel with_errors(const ModalBasis& truth, double contact, const ModelErrorOptions& errors,
                         const StreamKey& key);

/// Where the reactions come from: `scene` with `simulator` and `measurement`, or `record` with the
/// `string` that was played and the `bow` position x_c.
struct ObservationOptions {
  bool has_scene = false;
  TruthOptions truth;
  Measurement measurement;
  bool has_record = false;
  RecordOptions record;
  bool has_string = false;
  StringModel string{.modes = 0};
  bool has_bow = false;
  ContactOptions contact;
  void visit(OptionVisitor& visitor);

  /// The string as stated: a record's may leave the number of modes to the record.
  const StringModel& string_model() const { return has_scene ? truth.scene.string : string; }
  double contact_point() const { return has_scene ? truth.scene.bow.position : contact.position; }
  /// Throws InvalidInput unless exactly one source is stated completely.
  void require_one_source() const;
};

/// What one key of an experiment states, against the record or the rest.
class WrongKey : public InvalidInput {
 public:
  WrongKey(std::string path, const std::string& text)
      : InvalidInput(text), path_(std::move(path)) {}
  const std::string& path() const { return path_; }  ///< "bow.position"

 private:
  std::string path_;
};

/// Reactions as measured, and the truth as far as it is known.
struct Observation {
  double sample_rate = 0.0;
  std::optional<Signal> reactions[2];  ///< index by End
  ModalBasis basis;                    ///< the model without errors put in
  double contact = 0.0;                ///< x_c [m]
  double fundamental = 0.0;            ///< f₀ [Hz]
  double noise_level = 0.0;            ///< as stated for a simulated measurement
  std::shared_ptr<const Truth> truth;  ///< null for a record
  std::optional<Signal> reference;  ///< true or recorded contact force, means removed with the rest
  std::optional<Signal> reference_velocity, reference_displacement;  ///< at the contact, recorded
  /// The true force low-passed before it was sampled, where a score asks for it.
  std::optional<Signal> anti_aliased;
  double anti_alias_cut = 0.0;  ///< [Hz]
  bool is_one_signal = false;   ///< both reactions, as those of a record bowed in the middle
  std::vector<std::string> warnings;
  std::string modes_taken;    ///< how many modes and why, where the record told; else empty
  std::string modes_missing;  ///< of a number of modes stated: that the record tells more

  const std::optional<Signal>& reaction(End end) const { return reactions[static_cast<int>(end)]; }
  std::size_t samples() const;
};

/// Simulates (through the cache) or reads, and measures with noise drawn from `key`.
/// `folder`: where a relative record path starts; `oversampling` > 1: with an anti-aliased truth.
Observation observe(const ObservationOptions& options, const OutputRequest& truth_outputs,
                    TruthCache& cache, const StreamKey& key, const std::filesystem::path& folder,
                    std::int64_t oversampling = 1);

/// Throws InvalidInput where a reaction is missing that `what` needs, which `option` asks for.
void require_both_reactions(const Observation& observation, std::string_view what,
                            std::string_view option);

/// "x = 0" or "x = L".
std::string_view label_of(End end);
inline constexpr End kEnds[] = {End::kLeft, End::kRight};

// Whether both reactions of a record are those of the string that is stated.

/// Why a sample rate [Hz] does not show the highest mode; empty where it does.
std::string explain_hidden_modes(const ModalBasis& basis, double sample_rate);

/// Throws InvalidInput where a record, called by its name, does not show the fundamental [Hz] at
/// its rate or holds less than two periods of it.
void require_periods(std::string_view name, double fundamental, std::size_t samples,
                     double sample_rate);

/// Throws InvalidInput where both recorded reactions hold another relation than that of a string's
/// ends (fit_end_relations()): nothing but noise, copies, a turned sign, exchanged ends, no common
/// string within 3 % of f₀ and 2 % of L, or one that is broken off somewhere in the record. False:
/// they are one signal, as a contact in the middle makes them, and tell nothing of the string.
bool require_one_string(const ObservationOptions& options, const RecordedSignals& signals);

/// Throws InvalidInput where both reactions of a record tell an f₀ more than 0.2 % from the one
/// stated, which they tell to 0.05 %: an inversion takes it for granted, and modes are 2ζ wide.
void require_told_fundamental(const ObservationOptions& options, const Observation& observation);

/// The string that explains both recorded reactions (find_string()), with the contact stated where
/// they do not tell it; none where there is none, or one reaction, or a simulation.
std::optional<ToldString> told_string(const Observation& observation);

}  // namespace modcal
