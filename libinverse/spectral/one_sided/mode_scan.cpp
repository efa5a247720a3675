#include "libinverse/spectral/one_sided/mode_scan.hpp"

#include <algorithm>
#include <cstddef>
#include <span>

#include "libinverse/spectral/one_sided/tuning.hpp"
#include "libsim/base/task_loop.hpp"
#include "libsim/model/modal_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libinverse/spectral/one_sided/mode_scan.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libsim/base/planar_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

// ModalPole::denominator() on the frequency axis.
HWY_INLINE ComplexVector Denominator(double omega_n, double zeta, const double* omegas) {
  const Tag d;
  const auto pole = hn::Set(d, omega_n), omega = hn::LoadU(d, omegas);
  return {hn::Mul(hn::Sub(pole, omega), hn::Add(pole, omega)),
          hn::Mul(omega, hn::Set(d, 2.0 * zeta * omega_n))};
}

// |rest D + A|².
HWY_INLINE Vector NumeratorPower(const ScannedSensor& sensor, std::size_t i,
                                 const ComplexVector& denominator) {
  const Tag d;
  const auto real = hn::LoadU(d, sensor.real + i);
  const auto imag = hn::LoadU(d, sensor.imag + i);
  const ComplexVector sum{
      hn::MulAdd(real, denominator.re,
                 hn::NegMulAdd(imag, denominator.im, hn::Set(d, sensor.constant))),
      hn::MulAdd(real, denominator.im, hn::Mul(imag, denominator.re))};
  return Power(sum);
}

// 1/√x for normal x > 0 within 1e-4.
HWY_INLINE Vector RoughInverseRoot(Vector x) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  return Vector{_mm512_rsqrt14_pd(x.raw)};
#else
  // Half the exponent by an integer shift, within 3.5 %, then a cubic step.
  const Tag d;
  const hn::RebindToUnsigned<Tag> du;
  const auto bits = hn::ShiftRight<1>(hn::BitCast(du, x));
  const auto y = hn::BitCast(d, hn::Sub(hn::Set(du, 0x5FE6EB50C7B537A9ull), bits));
  const auto r = hn::Mul(x, hn::Mul(y, y));
  const auto cubic = hn::MulAdd(r, hn::Set(d, 0.375), hn::Set(d, -1.25));
  return hn::Mul(y, hn::MulAdd(r, cubic, hn::Set(d, 1.875)));
#endif
}

// Two steps of Newton's: 1e-4 becomes 1.5e-8 and then less than rounding.
HWY_INLINE Vector InverseRoot(Vector x) {
  const Tag d;
  const auto half = hn::Mul(x, hn::Set(d, 0.5));
  auto y = RoughInverseRoot(x);
  y = hn::Mul(y, hn::NegMulAdd(hn::Mul(half, y), y, hn::Set(d, 1.5)));
  return hn::Mul(y, hn::NegMulAdd(hn::Mul(half, y), y, hn::Set(d, 1.5)));
}

// |D|/√n_1 by multiplications, as |D|²/√(|D|² n_1), |D|/√n_2 by the hardware's division and root:
// the two run side by side and take about the same time.
template <bool kBoth>
HWY_INLINE double Integrate(const ScannedSensor* sensors, std::span<const double> omegas,
                            double zeta, double candidate) {
  const Tag d;
  const ScannedSensor& last = sensors[kBoth ? 1 : 0];
  auto sum = hn::Zero(d);
  for (std::size_t i = 0; i < omegas.size(); i += hn::Lanes(d)) {
    const ComplexVector denominator = Denominator(candidate, zeta, omegas.data() + i);
    const auto power = Power(denominator);
    if constexpr (kBoth) {
      const auto root =
          hn::Mul(power, InverseRoot(hn::Mul(power, NumeratorPower(sensors[0], i, denominator))));
      sum = hn::MulAdd(hn::LoadU(d, sensors[0].magnitude + i), root, sum);
    }
    const auto root = hn::Sqrt(hn::Div(power, NumeratorPower(last, i, denominator)));
    sum = hn::MulAdd(hn::LoadU(d, last.magnitude + i), root, sum);
  }
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

// integrals_j += Σ_k Σ_sensors |R| |D| / |rest D + A| with D at ω_n = candidates_j [rad/s], for
// one sensor or two. Floor with both: a division, a square root and an inverse root per bin and
// candidate.
void IntegrateCandidates(std::span<const ScannedSensor> sensors, std::span<const double> omegas,
                         double zeta, std::span<const double> candidates,
                         std::span<double> integrals) {
  for (std::size_t j = 0; j < candidates.size(); ++j) {
    integrals[j] += sensors.size() == 2
                        ? Integrate<true>(sensors.data(), omegas, zeta, candidates[j])
                        : Integrate<false>(sensors.data(), omegas, zeta, candidates[j]);
  }
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {

HWY_EXPORT(IntegrateCandidates);

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
  const std::size_t blocks = (padded + kScanBlock - 1) / kScanBlock;
  partial_.assign(blocks * candidates.size(), 0.0);
  const auto integrate_block = [&](std::size_t block) {
    const std::size_t begin = block * kScanBlock, count = std::min(kScanBlock, padded - begin);
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
      HWY_DYNAMIC_DISPATCH(IntegrateCandidates)
      (std::span(part).subspan(r, std::min<std::size_t>(2, part.size() - r)),
       std::span(omegas_).subspan(begin, count), model.poles[mode].zeta, candidates, partial);
    }
  };
  if (blocks == 1) {
    integrate_block(0);
  } else {
    for_each_task(blocks, integrate_block);
  }
  std::fill(integrals.begin(), integrals.end(), 0.0);
  for (std::size_t j = 0; j < partial_.size(); ++j) integrals[j % candidates.size()] += partial_[j];
}

}  // namespace modcal
#endif
