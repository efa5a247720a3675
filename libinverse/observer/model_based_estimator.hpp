// Model-based estimate of the contact force: an observer whose friction law is fitted.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libinverse/estimator.hpp"
#include "libinverse/observer/disagreement.hpp"
#include "libinverse/observer/friction_candidates.hpp"
#include "libinverse/observer/observed_record.hpp"
#include "libinverse/observer/observer_runs.hpp"
#include "libinverse/observer/parameter_space.hpp"
#include "libsim/base/task_loop.hpp"
#include "libsim/model/modal_basis.hpp"

namespace modcal {

using observer::ModelBasedOptions;

/// How much of the static level of the force the data hold: the sensors lose it, and the samples
/// before the first wave arrives are all that give it back.
struct StaticRecovery {
  double level = 0.0;  ///< mean of the estimated force [N]
  /// Standard deviation of that level from the offsets' silent samples [N], by their noise and by
  /// what a string of finitely many modes ripples in them: the fit cannot do better unless its
  /// observer knows that ripple or the shape of the motion depends on the level.
  double deviation = 0.0;
};

/// What the estimate is off by as its difference to the joint estimate shows, which assumes no law.
struct ModelError {
  std::vector<observer::BandError> force_bands, velocity_bands;
  double band_limit = 0.0;  ///< below which the joint estimate knows the force [Hz]
  /// Mean square error of a sample that the deviations hold [N²], [(m/s)²]; 0 where the law
  /// explains the record.
  double force_square = 0.0, velocity_square = 0.0;
};

/// Its mean_force is that between samples, the static level of force as far as recovered.
struct ModelBasedResult : observer::ObserverMotion {
  /// f_c(t_k) [N] from its means between samples: steps within a sample do not fold back.
  std::vector<double> unaliased_force;
  observer::LinearEstimate linear;          ///< the linear estimate it started from
  observer::ObserverParameters parameters;  ///< in the frame of a bow that moves forward
  bool negated = false;                     ///< the bow moves in the negative direction
  double noise[2] = {};                     ///< estimated standard deviation of R₁, R₂ [N]
  double misfit = 0.0;  ///< J, mean Huber-ed (ν/s)²: 1 where model and noise are right
  /// Median of J over blocks of 256 samples: bursts in which the observer has lost the string do
  /// not count. This is what the warning goes by.
  double steady_misfit = 0.0;
  double expected_misfit = 1.0;   ///< what a right model leaves under the gains taken
  double misfit_deviation = 0.0;  ///< standard deviation of steady_misfit over records
  /// steady_misfit above which no law of the list is said to explain the record.
  double misfit_limit = std::numeric_limits<double>::infinity();
  /// At every sample under the sensors' noise, what that puts the parameters off by (a measured
  /// factor) and the model error: nothing in it for a static level that is off.
  observer::MotionDeviation deviation;
  Estimate joint;  ///< from both reactions, without a friction law
  ModelError model_error;
  StaticRecovery static_part;
  std::vector<double> gain_share;                 ///< share of blocks served by each listed gain
  std::vector<double> force_noise;                ///< the list of gains, q [N]
  std::size_t runs = 0;                           ///< observer runs taken
  std::vector<observer::FrictionCandidate> laws;  ///< the laws fitted, best supported first
  std::vector<std::string> warnings;
  /// Whether the law named explains the record to its noise.
  bool explained() const { return steady_misfit <= misfit_limit; }
};

/// Nonlinear observer (string + friction law, corrected at every sample by a steady Kalman gain)
/// whose parameters are fitted by prediction error, with a beam search over gains. Needs both
/// reactions, of a record that starts at rest. It assumes a friction law of the exponential family:
/// it stands beside a linear estimate, never in its place. As one of the estimators it has the side
/// "model"; what the static level rests on stands in the estimate's figures.
class ModelBasedEstimator final : public Estimator {
 public:
  using Options = ModelBasedOptions;
  /// Throws InvalidInput where no friction law or an unknown one is asked for.
  explicit ModelBasedEstimator(ModelBasedOptions options);
  /// Reactions [N] at x = 0 and x = L, contact x_c [m], sample_rate [Hz]; `recorded`: of a real
  /// string, which has modes above the last one. Throws InvalidInput as observer::observe_record()
  /// does and where the estimate is not to be had (require_finite_stiffness(),
  /// require_no_ringing()), and Interrupted where `stop` was requested.
  ModelBasedResult estimate(const ModalBasis& basis, double contact, double sample_rate,
                            std::span<const double> left, std::span<const double> right,
                            const StopToken& stop = {}, bool recorded = false,
                            std::optional<bool> bending = {}) const;
  std::vector<std::string> sides() const override { return {"model"}; }
  double numbers_per_sample() const override { return 100.0; }

 private:
  std::shared_ptr<const PreparedEstimator> do_prepare(const EstimationModel& model) const override;

  ModelBasedOptions options_;
};

}  // namespace modcal
