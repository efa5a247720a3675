// How the parameters of a calibration move the transfer functions to both ends.
#pragma once

#include <span>
#include <vector>

#include "libcalib/parameters/parameters.hpp"
#include "libcalib/problem/calibration_data.hpp"
#include "libinverse/spectral/one_sided/force_kernel.hpp"
#include "libsim/model/transfer.hpp"

namespace modcal {

/// H_1 and H_2 at one point.
inline ModalModel end_reactions(const ModelPoint& point) {
  return end_reactions(point.basis, point.contact);
}

/// Both reactions of a calibration over some bins.
RecordBand band_of(const CalibrationData& data, const BinRange& bins);

/// ∂H_r/∂x_i over the bins of a record, of the parameters that move poles or the contact.
class ModelSlopes {
 public:
  /// The set and the record must outlive it.
  ModelSlopes(const ParameterSet& parameters, std::span<const double> x, const RecordBand& record);
  /// Into `slope`, one spectrum a sensor.
  void write(std::size_t i, SensorSpectra& slope) const;
  /// Σ Re(weights_rk ∂H_rk/∂x_i). Bins whose weight is 0 cost nothing; sensors with no weights are
  /// left out.
  double gather(std::size_t i, const SensorSpectra& weights) const;

 private:
  const ParameterSet& parameters_;
  const RecordBand& record_;
  std::vector<double> x_;
  ModalModel model_;
  SplitSpectra by_contact_;  // where x_c is free
};

}  // namespace modcal
