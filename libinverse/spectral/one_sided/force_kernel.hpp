// The force of a model and a record, sensor by sensor: what inversions write and what objectives
// compare while they search for the model.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "libinverse/regularizer.hpp"
#include "libsim/model/modal_model.hpp"

namespace modcal {

/// F = φ R/H in place of R, bin by bin: `inverse` is 1/H, 0 where H tells nothing of the force;
/// `kept` is φ.
void identify_force(std::span<const double> kept, std::span<const Complex> inverse,
                    std::span<Complex> force);

/// One spectrum a sensor.
using SensorSpectra = std::vector<std::vector<Complex>>;

/// Spectra of K sensors over consecutive bins; empty where a sensor was not recorded.
struct RecordBand {
  FrequencyGrid grid;
  BinRange bins;
  SensorSpectra spectra;
};

/// Φ of F = Φ R/H.
struct ForceFilter {
  std::shared_ptr<const Regularizer> regularizer;  ///< null: Φ = 1
  double parameter = 0.0;                          ///< of the regularizer, in the unit of H
  /// Φ is the product of the factors φ(|H_k|) of all sensors, so that their forces are alike for
  /// the true model; else φ(|H_k|) of its own, as one-sided inversions filter.
  bool common = true;
};

/// F_k = Φ_k R_k/H_k over a band for models of one contact, with its slopes. The slope dφ/d|H| is a
/// central difference of the filter factors over ±1e-5 |H|: right to about 1e-10 where φ is smooth,
/// 0 on the steps of a water level that zeroes. Const and safe to use from several threads.
class ForceKernel {
 public:
  ForceKernel(RecordBand record, ForceFilter filter)
      : record_(std::move(record)), filter_(std::move(filter)) {}

  const RecordBand& record() const { return record_; }

  /// Everything known at one model.
  struct State {
    SensorSpectra transfer;                       ///< H_k
    SensorSpectra inverse;                        ///< 1/H_k, 0 where H_k = 0
    SensorSpectra force;                          ///< F_k as the DFT of a force; empty: no record
    std::vector<std::vector<double>> kept;        ///< φ(|H_k|)
    std::vector<std::vector<double>> kept_slope;  ///< dφ/d|H_k|; empty unless asked for
  };
  State at(const ModalModel& model, bool with_slopes) const;
  /// ∂F_k in place of ∂H_k; the state must have been asked for with slopes.
  void force_slope(const State& state, SensorSpectra& slope) const;

 private:
  void fill_filter(State& state, std::size_t sensor, bool with_slopes) const;
  double filter_at(const State& state, std::size_t sensor, std::size_t k) const;

  RecordBand record_;
  ForceFilter filter_;
};

}  // namespace modcal
