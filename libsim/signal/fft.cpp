#include "libsim/signal/fft.hpp"

#include <fftw3.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/base/stop_scope.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

namespace {

fftw_complex* as_fftw(Complex* values) { return reinterpret_cast<fftw_complex*>(values); }
double* samples_in(Complex* memory) { return reinterpret_cast<double*>(memory); }

// Callers of kApart bring arrays of their own, of any alignment.
enum class Memory { kApart, kInPlace, kInPlaceUnaligned };

}  // namespace

// Made when they are first asked for: of most lengths one direction is, and of arrays of the caller
// one alignment.
struct FftPlans {
  const std::size_t length;
  const Memory memory;

  FftPlans(std::size_t samples, Memory where) : length(samples), memory(where) {}
  FftPlans(const FftPlans&) = delete;
  FftPlans& operator=(const FftPlans&) = delete;
  ~FftPlans() {
    fftw_destroy_plan(forward_);
    fftw_destroy_plan(inverse_);
  }

  fftw_plan forward() const {
    std::call_once(forward_made_, [this] { forward_ = make(true); });
    return forward_;
  }
  fftw_plan inverse() const {
    std::call_once(inverse_made_, [this] { inverse_ = make(false); });
    return inverse_;
  }

 private:
  fftw_plan make(bool forward) const {
    // FFTW's planner is not thread-safe; executing a plan on new arrays is.
    static std::mutex planner;
    const std::lock_guard lock(planner);
    std::vector<Complex> spectrum(length / 2 + 1);
    std::vector<double> apart(memory == Memory::kApart ? length : 0);
    double* samples = apart.empty() ? samples_in(spectrum.data()) : apart.data();
    const int n = static_cast<int>(length);
    const unsigned flags =
        memory == Memory::kInPlace ? FFTW_ESTIMATE : FFTW_ESTIMATE | FFTW_UNALIGNED;
    const unsigned keep = apart.empty() ? 0 : FFTW_PRESERVE_INPUT;
    const unsigned spoil = apart.empty() ? 0 : FFTW_DESTROY_INPUT;
    return forward ? fftw_plan_dft_r2c_1d(n, samples, as_fftw(spectrum.data()), flags | keep)
                   : fftw_plan_dft_c2r_1d(n, as_fftw(spectrum.data()), samples, flags | spoil);
  }

  mutable std::once_flag forward_made_, inverse_made_;
  mutable fftw_plan forward_ = nullptr, inverse_ = nullptr;
};

namespace {

// Plans live as long as the process: their number is the number of distinct record lengths.
const FftPlans* plans_for(std::size_t length, Memory memory) {
  MODCAL_REQUIRE(length >= 1, "a Fourier transform needs at least one sample");
  static std::mutex mutex;
  static std::map<std::pair<std::size_t, Memory>, FftPlans> cache;
  const std::lock_guard lock(mutex);
  return &cache.try_emplace({length, memory}, length, memory).first->second;
}

}  // namespace

RealFft::RealFft(std::size_t length) : length_(length), plans_(plans_for(length, Memory::kApart)) {}

void RealFft::forward(std::span<const double> samples, std::span<Complex> spectrum) const {
  throw_if_stopped();
  assert(samples.size() == length_ && spectrum.size() == bins());
  // The plan preserves its input; FFTW's interface is merely not const.
  fftw_execute_dft_r2c(plans_->forward(), const_cast<double*>(samples.data()),
                       as_fftw(spectrum.data()));
}

void RealFft::inverse(std::span<Complex> spectrum, std::span<double> samples) const {
  throw_if_stopped();
  assert(samples.size() == length_ && spectrum.size() == bins());
  fftw_execute_dft_c2r(plans_->inverse(), as_fftw(spectrum.data()), samples.data());
  const double scale = 1.0 / static_cast<double>(length_);
  std::transform(samples.begin(), samples.end(), samples.begin(),
                 [scale](double value) { return scale * value; });
}

std::vector<Complex> RealFft::forward(std::span<const double> samples) const {
  std::vector<Complex> spectrum(bins());
  forward(samples, spectrum);
  return spectrum;
}

std::vector<double> RealFft::inverse(std::vector<Complex> spectrum) const {
  std::vector<double> samples(length_);
  inverse(spectrum, samples);
  return samples;
}

InPlaceFft::InPlaceFft(std::size_t length)
    : length_(length),
      aligned_(plans_for(length, Memory::kInPlace)),
      unaligned_(plans_for(length, Memory::kInPlaceUnaligned)) {}

void InPlaceFft::forward(std::span<Complex> memory) const {
  throw_if_stopped();
  assert(memory.size() == bins());
  double* samples = modcal::samples_in(memory.data());
  const FftPlans* plans = fftw_alignment_of(samples) == 0 ? aligned_ : unaligned_;
  fftw_execute_dft_r2c(plans->forward(), samples, as_fftw(memory.data()));
}

void InPlaceFft::inverse(std::span<Complex> memory) const {
  throw_if_stopped();
  assert(memory.size() == bins());
  double* samples = modcal::samples_in(memory.data());
  const FftPlans* plans = fftw_alignment_of(samples) == 0 ? aligned_ : unaligned_;
  fftw_execute_dft_c2r(plans->inverse(), as_fftw(memory.data()), samples);
}

double bin_multiplicity(std::size_t k, std::size_t length) {
  return k == 0 || 2 * k == length ? 1.0 : 2.0;
}

std::vector<Complex> hann_spectrum(std::span<const double> samples, std::size_t first,
                                   std::size_t last) {
  const std::size_t end = std::min(last, samples.size());
  std::vector<double> windowed(samples.begin(), samples.end());
  std::fill(windowed.begin(), windowed.begin() + static_cast<long>(first), 0.0);
  std::fill(windowed.begin() + static_cast<long>(end), windowed.end(), 0.0);
  const std::span<double> part = std::span(windowed).subspan(first, end - first);
  remove_mean(part);
  double energy = 0.0;
  for (std::size_t j = 0; j < part.size(); ++j) {
    const double turn = static_cast<double>(j) / static_cast<double>(part.size());
    const double weight = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * turn);
    part[j] *= weight;
    energy += weight * weight;
  }
  std::vector<Complex> spectrum = RealFft(windowed.size()).forward(windowed);
  const double scale = 1.0 / std::sqrt(energy);
  for (Complex& bin : spectrum) bin *= scale;
  return spectrum;
}

}  // namespace modcal
