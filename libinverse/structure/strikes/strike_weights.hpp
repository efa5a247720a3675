// Weights of the bins of a strike, and what its residuals say of the sensors.
#pragma once

#include "libinverse/structure/structure_record.hpp"
#include "libinverse/structure/structure_table.hpp"

namespace modcal {

using BinWeights = std::vector<std::vector<double>>;  ///< 1/σ of every bin, by sensor

/// Mean of |x|².
double mean_power(const std::vector<Complex>& spectrum);

/// σ a share of the response about the bin, and a tenth of that share of its rms.
BinWeights weights_of(const ContourSpectra& spectra, double share);

/// |F|² Σ_n |H_n|² of a sensor in every bin.
std::vector<double> made_by_modes(const ContourSpectra& spectra, const ModalModel& model,
                                  std::size_t sensor);

/// σ² = ε² |F|² Σ_n |H_n|² + noise, by the scatter of each sensor.
BinWeights weights_of(const ContourSpectra& spectra, const ModalModel& model,
                      const std::vector<SensorScatter>& scatters);

/// Largest likelihood of |residual|², exponential about ε² |F|² Σ_n |H_n|² + noise (Itakura and
/// Saito's divergence, by multiplicative steps). Of `correlated` bins one counts; a scatter that
/// does not raise it by two deviations is that of the few bins of a peak, not of the model.
SensorScatter scatter_of(const std::vector<double>& left, const std::vector<double>& modal,
                         double noise_power, double correlated);

}  // namespace modcal
