#include "libcalib/objectives/model_slopes.hpp"

#include <array>

namespace modcal {

RecordBand band_of(const CalibrationData& data, const BinRange& bins) {
  RecordBand record{.grid = data.grid(), .bins = bins};
  for (const std::vector<Complex>& reaction : data.reactions) {
    auto& spectrum = record.spectra.emplace_back();
    if (reaction.empty()) continue;
    const auto begin = reaction.begin() + static_cast<std::ptrdiff_t>(bins.first);
    spectrum.assign(begin, begin + static_cast<std::ptrdiff_t>(bins.size()));
  }
  return record;
}

ModelSlopes::ModelSlopes(const ParameterSet& parameters, std::span<const double> x,
                         const RecordBand& record)
    : parameters_(parameters), record_(record), x_(x.begin(), x.end()) {
  const ModelPoint point = parameters.model(x);
  model_ = end_reactions(point);
  if (!parameters.has(ParameterKind::kContact)) return;
  end_reaction_slopes(point.basis, point.contact)
      .evaluate_in_parallel(record.grid, record.bins, by_contact_);
}

void ModelSlopes::write(std::size_t i, SensorSpectra& slope) const {
  const std::size_t bins = record_.bins.size(), sensors = model_.pairs();
  slope.assign(sensors, std::vector<Complex>(bins, 0.0));
  std::array<Complex, 2> change;
  for (const auto& [mode, omega_slope] : parameters_.frequency_slopes(x_, i)) {
    for (std::size_t k = 0; k < bins; ++k) {
      model_.pole_slopes(mode, record_.grid.s(record_.bins.first + k), omega_slope, 0.0, change);
      for (std::size_t r = 0; r < sensors; ++r) slope[r][k] += change[r];
    }
  }
  if (parameters_[i].kind != ParameterKind::kContact) return;
  for (std::size_t r = 0; r < sensors; ++r) slope[r] = by_contact_.joined(r);
}

double ModelSlopes::gather(std::size_t i, const SensorSpectra& weights) const {
  const auto slopes = parameters_.frequency_slopes(x_, i);
  const bool contact = parameters_[i].kind == ParameterKind::kContact;
  const auto weight_at = [&](std::size_t r, std::size_t k) {
    return weights[r].empty() ? Complex(0.0) : weights[r][k];
  };
  std::array<Complex, 2> change;
  double sum = 0.0;
  for (std::size_t k = 0; k < record_.bins.size(); ++k) {
    const Complex left = weight_at(0, k), right = weight_at(1, k);
    if (left == 0.0 && right == 0.0) continue;
    for (const auto& [mode, omega_slope] : slopes) {
      model_.pole_slopes(mode, record_.grid.s(record_.bins.first + k), omega_slope, 0.0, change);
      sum += (left * change[0] + right * change[1]).real();
    }
    if (contact) sum += (left * by_contact_.at(0, k) + right * by_contact_.at(1, k)).real();
  }
  return sum;
}

}  // namespace modcal
