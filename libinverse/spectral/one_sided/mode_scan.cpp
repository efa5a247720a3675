#include "libinverse/spectral/one_sided/mode_scan.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "libinverse/spectral/one_sided/mode_scan_kernel.hpp"
#include "libsim/model/modal_kernel.hpp"

namespace modcal {
namespace {

// Bins of a task, some ten microseconds of work for 50 modes and 50 candidates; a multiple of
// kBinLanes.
constexpr std::size_t kBlock = 96;

}  // namespace

void ModeScan::integrate(const ModalModel& model, std::size_t mode, const FrequencyGrid& grid,
                         const BinRange& bins, std::span<const std::vector<double>> magnitudes,
                         std::span<const double> candidates, std::span<double> integrals) {
  const std::size_t padded = (bins.size() + kBinLanes - 1) / kBinLanes * kBinLanes;
  ModalModel others = model;
  std::vector<ScannedSensor> sensors;
  magnitudes_.resize(magnitudes.size());
  rest_.resize(magnitudes.size(), padded);
  for (std::size_t r = 0; r < magnitudes.size(); ++r) {
    others.constants[r * model.poles.size() + mode] = 0.0;
    if (magnitudes[r].empty()) continue;
    const auto begin = magnitudes[r].begin() + static_cast<std::ptrdiff_t>(bins.first);
    magnitudes_[r].assign(begin, begin + static_cast<std::ptrdiff_t>(bins.size()));
    magnitudes_[r].resize(padded, 0.0);
    sensors.push_back(
        {rest_.real(r), rest_.imag(r), magnitudes_[r].data(), model.constant(r, mode)});
  }
  omegas_.resize(padded);
  for (std::size_t k = 0; k < padded; ++k) omegas_[k] = grid.omega(bins.first + k);
  const ModalSums sums(others);
  const std::size_t blocks = (padded + kBlock - 1) / kBlock;
  partial_.assign(blocks * candidates.size(), 0.0);
  const auto integrate_block = [&](std::size_t block) {
    const std::size_t begin = block * kBlock, count = std::min(kBlock, padded - begin);
    sums.evaluate(grid, {bins.first + begin, bins.first + begin + count}, begin, rest_);
    std::vector<ScannedSensor> part = sensors;
    for (ScannedSensor& sensor : part) {
      sensor.real += begin;
      sensor.imag += begin;
      sensor.magnitude += begin;
    }
    const std::span<double> partial =
        std::span(partial_).subspan(block * candidates.size(), candidates.size());
    for (std::size_t r = 0; r < part.size(); r += 2) {
      integrate_candidates(std::span(part).subspan(r, std::min<std::size_t>(2, part.size() - r)),
                           std::span(omegas_).subspan(begin, count), model.poles[mode].zeta,
                           candidates, partial);
    }
  };
  if (blocks == 1) {
    integrate_block(0);
  } else {
    tbb::parallel_for(std::size_t{0}, blocks, integrate_block);
  }
  std::fill(integrals.begin(), integrals.end(), 0.0);
  for (std::size_t j = 0; j < partial_.size(); ++j) integrals[j % candidates.size()] += partial_[j];
}

}  // namespace modcal
