// Runs of the observer over a record for given parameters.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "libinverse/observer/observed_record.hpp"
#include "libinverse/observer/parameter_space.hpp"
#include "libinverse/observer/steady_gain.hpp"
#include "libsim/base/random.hpp"

namespace modcal::observer {

/// Which gain of the list serves each block; one element: the whole record.
using GainSchedule = std::vector<std::size_t>;

/// ν/s of both reactions, sample by sample.
struct Innovations {
  std::vector<double> scaled[2];
};

struct ObserverMotion {
  std::vector<double> force;         ///< f_c(t_k) [N]
  std::vector<double> velocity;      ///< v(x_c, t_k) [m/s]
  std::vector<double> displacement;  ///< y(x_c, t_k) [m]
  std::vector<double> mean_force;    ///< of f_c from one sample to the next [N]
};

struct MotionDeviation {
  std::vector<double> force;     ///< [N]
  std::vector<double> velocity;  ///< [m/s]
};

/// Model and data of one set of parameters, ready to run.
class PreparedObserver {
 public:
  const StringTables& string() const { return *string_; }
  /// Starts at rest.
  ObserverState initial_state() const;
  /// Output arrays begin at sample `origin`.
  void run(std::size_t gain, std::size_t first, std::size_t last, ObserverState& state,
           const ObserverSignals& outputs, std::size_t origin = 0) const;

 private:
  const double* reaction(std::size_t r) const {
    return changed_[r].empty() ? recorded_[r] : changed_[r].data();
  }

  friend class ObserverRuns;
  std::shared_ptr<const StringTables> string_;
  ContactLaw contact_;
  const double* recorded_[2] = {};
  std::vector<double> changed_[2];  // empty: as recorded
  std::vector<double> force_scale_, bow_velocity_;
  std::shared_ptr<const std::vector<GainTable>> gains_;
};

class ObserverRuns {
 public:
  /// `force_noise`: the list of gains, q [N]. The record must outlive this object.
  ObserverRuns(const ObservedRecord& record, std::vector<double> force_noise, Substeps substeps);

  const ObservedRecord& record() const { return record_; }
  const std::vector<double>& force_noise() const { return force_noise_; }
  const StringTables& string() const { return *string_; }
  /// Misfit that a right model leaves under each of the gains (SteadyGain::quiet_misfit).
  const std::vector<double>& quiet_misfit() const { return quiet_misfit_; }
  PreparedObserver prepare(const ObserverParameters& parameters) const;
  /// Innovations of the first `samples` samples and, where asked for, the identified motion.
  Innovations innovations(const ObserverParameters& parameters, const GainSchedule& schedule,
                          std::size_t samples, ObserverMotion* motion = nullptr) const {
    return run_schedule(prepare(parameters), schedule, samples, motion);
  }
  /// Standard deviation of force and velocity at every sample under the sensors' noise alone: rms
  /// change of the motion over `draws` of further noise of the same strength, drawn from `key`, the
  /// parameters held.
  MotionDeviation deviation(const ObserverParameters& parameters, const GainSchedule& schedule,
                            std::size_t draws, const StreamKey& key) const;

 private:
  std::shared_ptr<const StringTables> tables_of(const ObserverParameters& parameters) const;
  std::vector<GainTable> gains_for(const StringTables& string) const;
  PreparedObserver disturbed(const ObserverParameters& parameters, const StreamKey& key) const;
  Innovations run_schedule(const PreparedObserver& observer, const GainSchedule& schedule,
                           std::size_t samples, ObserverMotion* motion) const;

  const ObservedRecord& record_;
  std::vector<double> force_noise_;
  Substeps substeps_;
  std::shared_ptr<const StringTables> string_;
  std::vector<GainTable> nominal_;  // of the record's own model
  std::vector<double> quiet_misfit_;
  std::shared_ptr<const std::vector<GainTable>> gains_;
};

/// Σ 2ρ(ν/s) of both reactions over every whole block of kGainBlock samples.
std::vector<double> block_costs(const Innovations& innovations);

/// Median over the blocks of the mean of 2ρ(ν/s): bursts in which the observer has lost the string,
/// most of them in the transient, do not count.
double steady_misfit(const Innovations& innovations);

/// Mean of 2ρ(ν/s) with Huber's ρ: 1 for an observer whose model and noise are right.
double misfit(const Innovations& innovations);

/// Huber's ρ(r): r²/2 up to kHuberCorner, linear beyond.
double huber(double r);

}  // namespace modcal::observer
