#include "libsim/signal/fft.hpp"

#include <fftw3.h>

#include <algorithm>
#include <cassert>
#include <map>
#include <memory>
#include <mutex>

#include "libsim/base/error.hpp"

namespace modcal {

struct RealFft::Plans {
  fftw_plan forward = nullptr;
  fftw_plan inverse = nullptr;

  Plans() = default;
  Plans(const Plans&) = delete;
  Plans& operator=(const Plans&) = delete;
  ~Plans() {
    fftw_destroy_plan(forward);
    fftw_destroy_plan(inverse);
  }
};

namespace {

fftw_complex* as_fftw(Complex* values) { return reinterpret_cast<fftw_complex*>(values); }

// FFTW's planner is not thread-safe; executing a plan on new arrays is.
std::mutex& planner_mutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

RealFft::RealFft(std::size_t length) : length_(length) {
  MODCAL_REQUIRE(length >= 1, "a Fourier transform needs at least one sample");
  // Plans live as long as the process: their number is the number of distinct record lengths.
  static std::map<std::size_t, std::unique_ptr<Plans>> cache;
  const std::lock_guard lock(planner_mutex());
  std::unique_ptr<Plans>& slot = cache[length];
  if (!slot) {
    std::vector<double> samples(length);
    std::vector<Complex> spectrum(bins());
    const int n = static_cast<int>(length);
    // Unaligned: callers bring their own arrays.
    const unsigned flags = FFTW_ESTIMATE | FFTW_UNALIGNED;
    slot = std::make_unique<Plans>();
    slot->forward = fftw_plan_dft_r2c_1d(n, samples.data(), as_fftw(spectrum.data()),
                                         flags | FFTW_PRESERVE_INPUT);
    slot->inverse = fftw_plan_dft_c2r_1d(n, as_fftw(spectrum.data()), samples.data(),
                                         flags | FFTW_DESTROY_INPUT);
  }
  plans_ = slot.get();
}

void RealFft::forward(std::span<const double> samples, std::span<Complex> spectrum) const {
  assert(samples.size() == length_ && spectrum.size() == bins());
  // The plan preserves its input; FFTW's interface is merely not const.
  fftw_execute_dft_r2c(plans_->forward, const_cast<double*>(samples.data()),
                       as_fftw(spectrum.data()));
}

void RealFft::inverse(std::span<Complex> spectrum, std::span<double> samples) const {
  assert(samples.size() == length_ && spectrum.size() == bins());
  fftw_execute_dft_c2r(plans_->inverse, as_fftw(spectrum.data()), samples.data());
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

struct InPlaceFft::Plans {
  // Aligned to 16 bytes or not.
  fftw_plan forward[2] = {nullptr, nullptr};
  fftw_plan inverse[2] = {nullptr, nullptr};

  explicit Plans(std::size_t length) {
    std::vector<Complex> memory(length / 2 + 1);
    auto* samples = reinterpret_cast<double*>(memory.data());
    const int n = static_cast<int>(length);
    for (std::size_t i = 0; i < 2; ++i) {
      const unsigned flags = i == 0 ? FFTW_ESTIMATE : FFTW_ESTIMATE | FFTW_UNALIGNED;
      forward[i] = fftw_plan_dft_r2c_1d(n, samples, as_fftw(memory.data()), flags);
      inverse[i] = fftw_plan_dft_c2r_1d(n, as_fftw(memory.data()), samples, flags);
    }
  }
  Plans(const Plans&) = delete;
  Plans& operator=(const Plans&) = delete;
  ~Plans() {
    for (std::size_t i = 0; i < 2; ++i) {
      fftw_destroy_plan(forward[i]);
      fftw_destroy_plan(inverse[i]);
    }
  }
};

InPlaceFft::InPlaceFft(std::size_t length) : length_(length) {
  MODCAL_REQUIRE(length >= 1, "a Fourier transform needs at least one sample");
  static std::map<std::size_t, std::unique_ptr<Plans>> cache;
  const std::lock_guard lock(planner_mutex());
  std::unique_ptr<Plans>& slot = cache[length];
  if (!slot) slot = std::make_unique<Plans>(length);
  plans_ = slot.get();
}

void InPlaceFft::forward(std::span<Complex> memory) const {
  assert(memory.size() == bins());
  auto* samples = reinterpret_cast<double*>(memory.data());
  fftw_execute_dft_r2c(plans_->forward[fftw_alignment_of(samples) == 0 ? 0 : 1], samples,
                       as_fftw(memory.data()));
}

void InPlaceFft::inverse(std::span<Complex> memory) const {
  assert(memory.size() == bins());
  auto* samples = reinterpret_cast<double*>(memory.data());
  fftw_execute_dft_c2r(plans_->inverse[fftw_alignment_of(samples) == 0 ? 0 : 1],
                       as_fftw(memory.data()), samples);
}

double bin_multiplicity(std::size_t k, std::size_t length) {
  return k == 0 || 2 * k == length ? 1.0 : 2.0;
}

}  // namespace modcal
