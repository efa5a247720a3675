// What a calibration to the bound is told and what it finds: law, modes, records, verdicts.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "libcalib/identifiability/law_followers.hpp"
#include "libcalib/identifiability/local_misfit.hpp"
#include "libcalib/identifiability/misfit_causes.hpp"
#include "libcalib/identifiability/model_posterior.hpp"
#include "libcalib/likelihood/records/likelihood_band.hpp"
#include "libcalib/parameters/named_covariance.hpp"
#include "libcalib/parameters/string_unknowns.hpp"
#include "libcalib/problem/optimization_result.hpp"

namespace modcal {

struct ContinuationOptions {
  /// Free every f_n after the law; false: the law alone.
  bool frequencies = true;
  /// Relative width τ of the prior of f_n about the law; NaN: estimated from the well-seen modes
  /// [1].
  double law_width = std::numeric_limits<double>::quiet_NaN();
  /// Highest frequency used [Hz]; NaN: 1.05 times that of the highest mode.
  double highest_frequency = std::numeric_limits<double>::quiet_NaN();
  /// Noise standard deviation of each reaction [N]; NaN: estimated from the record.
  double left_noise = std::numeric_limits<double>::quiet_NaN();
  double right_noise = std::numeric_limits<double>::quiet_NaN();
  UnknownsOptions unknowns;   ///< damping and sensors
  std::int64_t restarts = 4;  ///< other starts tried while χ² says that the fit is wrong
  ParameterRanges ranges;     ///< how far all that is free may go
  /// Called with the model and the reduced χ² that a stage ended with; empty: nobody asks.
  std::function<void(const ModelPoint&, double chi2)> reached = {};
};

/// Where the frequency of a mode comes from.
enum class ModeSource { kIdentified, kLaw, kPrior, kBlind, kFixed };
/// Why a mode is weak.
enum class WeakReason { kNone, kNode, kAntinode, kNoise, kDoubt };
std::string_view name_of(ModeSource source);
std::string_view name_of(WeakReason reason);

struct ModeVerdict {
  double frequency = 0.0;  ///< [Hz]
  double deviation = 0.0;  ///< relative standard deviation of the frequency reported
  /// What the data tell of it: the same under 0.2 % about the law and what is stated of anything
  /// but single frequencies.
  double data_deviation = 0.0;
  ModeSource source = ModeSource::kIdentified;
  WeakReason reason = WeakReason::kNone;
  LawTie tie = LawTie::kFollows;  ///< whether it was found to follow the law of the others
  double departure = 0.0;         ///< frequency beyond the law's, relative; where all are free
};

/// f_0 [Hz], B [1], x_c [m] and the factor of all damping ratios, with standard deviations.
struct LawEstimate {
  double fundamental = 0.0, inharmonicity = 0.0, contact = 0.0, damping = 1.0;
  std::array<double, 4> deviation{};  ///< of the four above, in this order
  double chi2 = 0.0;                  ///< reduced
  bool accepted = false;              ///< χ² does not contradict the law
  PriorMisfit priors;
  NamedCovariance covariance;  ///< of f0, B, x_c, damping and sensors, as far as they are free
};

/// The law that the frequencies found follow; their scatter about it is in the deviations.
struct FoundLaw {
  double fundamental = 0.0, inharmonicity = 0.0;
  std::array<double, 2> deviation{};
  static FoundLaw of(const LawPosterior& posterior, const StatedPriors& priors);
  static FoundLaw of(const LawEstimate& law) {
    return {law.fundamental, law.inharmonicity, {law.deviation[0], law.deviation[1]}};
  }
};

/// Sensors and damping as one record has them, its own or shared.
struct RecordValues {
  Sensor sensors;
  /// Of gain, delay [s], corner [Hz]; 0: not free.
  std::array<double, Sensor::kCount> sensor_deviation{};
  /// Factor of all initial ζ_n that are free; where each is, their geometric mean.
  double damping = 1.0;
  double damping_deviation = 0.0;
};

struct ContinuationResult {
  ModelPoint model;
  std::vector<double> contacts;            ///< x_c of every stroke [m]
  std::vector<double> contact_deviations;  ///< [m]
  std::vector<RecordValues> values;        ///< of every stroke, then of every pluck
  std::vector<ContinuationResult> single;  ///< of several records every stroke by itself
  LawEstimate law;                         ///< fitted alone
  FoundLaw found_law;  ///< through the frequencies, where each is free; else `law`
  bool frequencies_free = false;
  std::vector<ModeVerdict> modes;
  /// Relative standard deviations of f_n by several records, where every frequency is free.
  std::vector<double> frequency_deviations;
  double contact_deviation = 0.0;  ///< [m]
  /// Factor of all initial ζ_n that are free; where each is, their geometric mean.
  double damping = 1.0;
  double damping_deviation = 0.0;
  double damping_power = 0.0;  ///< exponent p in ζ_n = factor nᵖ ζ_n(initial)
  double damping_power_deviation = 0.0;
  std::vector<double> ratio_deviations;  ///< of every ζ_n, relative; empty unless each is free
  /// Of gain, delay [s] and corner [Hz] of model.sensors; 0: not free.
  std::array<double, Sensor::kCount> sensor_deviation{};
  /// Of the real and imaginary parts of the knots of model.sensors.smooth; empty: not free.
  std::vector<std::complex<double>> response_deviations;
  /// Of all that is free in `model`: f_n or f0 and B, x_c, damping, sensors. The roots of its
  /// diagonal are the deviations reported; what a verdict adds to that of a frequency, in its place
  /// alone.
  NamedCovariance covariance;
  ModelPosterior posterior;  ///< of the first record's model
  double law_width = 0.0;    ///< τ
  double chi2 = 0.0;         ///< reduced, of `model`
  double chi2_deviation = 0.0;
  bool fits = false;     ///< χ² does not contradict the result: χ² < 1 + 3 sd
  PriorMisfit priors;    ///< of `model` to what was stated beforehand
  bool right = false;    ///< neither χ² nor priors nor a cause of misfit contradict the result
  bool repeats = false;  ///< found what another start had led to, and no more was done
  std::size_t restarts = 0;
  std::size_t moved_modes = 0;  ///< modes found in a neighboring minimum and moved
  std::size_t evaluations = 0;
  std::vector<FitStage> stages;   ///< of all starts, in order
  std::array<double, 2> noise{};  ///< s_r [N]
  NoiseSpectrum noise_spectrum;   ///< over s_r²
  double noise_error = 0.0;       ///< relative standard deviation of the noise's power
  /// Of causes of misfit in each stroke, where every frequency is free and tests are asked for.
  std::vector<ScoreTest> tests;
  /// Causes that a fit before this one named, whose amplitudes are free in this one.
  std::vector<ScoreTest> freed;
  /// Of the first stroke by itself, where every frequency is free.
  LocalMisfit local;
  std::vector<double> lines;  ///< of the mains, free in the first record [Hz]

  /// Neither χ² nor what was stated contradicts the law.
  bool law_holds() const { return law.accepted && !law.priors.contradicted(); }
  /// Of a law that something contradicts nothing is reported but that.
  bool tells_of_law() const { return !frequencies_free || law_holds(); }
  /// Of the modes identified that follow the law the largest distance from found_law, over what
  /// their deviations and their scatter about it expect; 0: frequencies are not free.
  double farthest_follower() const;
  /// Modes and the law found with them are not of one minimum.
  bool contradicts_itself() const;
};

}  // namespace modcal
