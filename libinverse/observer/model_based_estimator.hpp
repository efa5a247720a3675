// Model-based estimate of the contact force: an observer whose friction law is fitted.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "libinverse/observer/friction_candidates.hpp"
#include "libinverse/observer/parameter_space.hpp"
#include "libsim/base/options.hpp"
#include "libsim/model/modal_basis.hpp"

namespace modcal {

struct ModelBasedOptions {
  /// Friction laws fitted; with several, the one with the least BIC is taken.
  std::vector<std::string> laws = {"exponential"};
  std::int64_t substeps = 5;        ///< steps of the observer per sample while it is fitted
  std::int64_t rounds = 3;          ///< of gain search and fit
  bool adherence_damping = false;   ///< frees C_a, else 2√(K_a m_eff)
  std::int64_t force_knots = 0;     ///< of ln F_N(t); 0: constant
  std::int64_t velocity_knots = 0;  ///< of v_bow(t); 0: constant
  bool delay = false;               ///< frees the delay between the two sensors
  bool gain = false;                ///< frees the gain ratio of the two sensors
  bool contact = false;             ///< frees x_c
  bool frequencies = false;         ///< frees every ω_n
  /// Steady J above which the result warns; NaN: four standard deviations above what a right model
  /// leaves.
  double misfit_limit = std::numeric_limits<double>::quiet_NaN();
  void visit(OptionVisitor& visitor);
};

/// How much of the static level of the force the data hold: the sensors lose it, and the samples
/// before the first wave arrives are all that give it back.
struct StaticRecovery {
  double level = 0.0;  ///< mean of the estimated force [N]
  /// Standard deviation of that level from the offsets' silent samples [N], by their noise and by
  /// what a string of finitely many modes ripples in them: the fit cannot do better unless its
  /// observer knows that ripple or the shape of the motion depends on the level.
  double deviation = 0.0;
};

struct ModelBasedResult {
  std::vector<double> force;         ///< f_c(t_k) [N], with its static level as far as recovered
  std::vector<double> velocity;      ///< v(x_c, t_k) [m/s]
  std::vector<double> displacement;  ///< y(x_c, t_k) [m]
  /// f_c(t_k) [N] from its means between samples: steps within a sample do not fold back.
  std::vector<double> unaliased_force;
  std::vector<double> linear_force;         ///< the linear estimate it started from [N]
  std::vector<double> linear_velocity;      ///< and its velocity [m/s]
  std::vector<double> linear_deviation;     ///< of linear_force under the sensors' noise [N]
  observer::ObserverParameters parameters;  ///< in the frame of a bow that moves forward
  bool negated = false;                     ///< the bow moves in the negative direction
  double noise[2] = {};                     ///< estimated standard deviation of R₁, R₂ [N]
  double misfit = 0.0;  ///< J, mean Huber-ed (ν/s)²: 1 where model and noise are right
  /// Median of J over blocks of 256 samples: bursts in which the observer has lost the string do
  /// not count. This is what the warning goes by.
  double steady_misfit = 0.0;
  double expected_misfit = 1.0;   ///< what a right model leaves under the gains taken
  double misfit_deviation = 0.0;  ///< standard deviation of steady_misfit over records
  /// Standard deviation of force [N] and velocity [m/s] at every sample under the sensors' noise
  /// and what that puts the parameters off by (a measured factor): nothing in it for a wrong law or
  /// a static level that is off.
  std::vector<double> force_deviation, velocity_deviation;
  StaticRecovery static_part;
  std::vector<double> gain_share;                 ///< share of blocks served by each listed gain
  std::vector<double> force_noise;                ///< the list of gains, q [N]
  std::size_t runs = 0;                           ///< observer runs taken
  std::vector<observer::FrictionCandidate> laws;  ///< the laws fitted, best supported first
  std::vector<std::string> warnings;
};

/// Nonlinear observer (string + friction law, corrected at every sample by a steady Kalman gain)
/// whose parameters are fitted by prediction error, with a beam search over gains. Needs both
/// reactions, of a record that starts at rest. It assumes a friction law of the exponential family:
/// it stands beside a linear estimate, never in its place.
class ModelBasedEstimator {
 public:
  /// Throws InvalidInput where no friction law or an unknown one is asked for.
  explicit ModelBasedEstimator(ModelBasedOptions options);
  /// Reactions [N] at x = 0 and x = L, contact x_c [m], sample_rate [Hz]. Throws InvalidInput as
  /// observer::observe_record does, and Interrupted when `interrupted` says so.
  ModelBasedResult estimate(
      const ModalBasis& basis, double contact, double sample_rate, std::span<const double> left,
      std::span<const double> right,
      const std::function<bool()>& interrupted = [] { return false; }) const;

 private:
  ModelBasedOptions options_;
};

}  // namespace modcal
