// Storage that starts on a cache line, so that no vector load of a kernel crosses one.
#pragma once

#include <complex>
#include <cstddef>
#include <new>
#include <vector>

namespace modcal {

template <typename T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlignment{64};

  CacheLineAllocator() = default;
  template <typename U>
  CacheLineAllocator(const CacheLineAllocator<U>&) {}  // NOLINT: allocators convert
  T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new(count * sizeof(T), kAlignment));
  }
  void deallocate(T* pointer, std::size_t) { ::operator delete(pointer, kAlignment); }
  bool operator==(const CacheLineAllocator&) const { return true; }
};

using AlignedVector = std::vector<double, CacheLineAllocator<double>>;

/// Doubles in the widest vector in use: kernels work on whole vectors and have no tail.
inline constexpr std::size_t kVectorPadding = 8;

constexpr std::size_t padded_size(std::size_t size) {
  return (size + kVectorPadding - 1) / kVectorPadding * kVectorPadding;
}

/// Complex numbers with real and imaginary parts apart, padded with zeros to whole vectors.
struct PlanarVector {
  AlignedVector re, im;

  PlanarVector() = default;
  explicit PlanarVector(std::size_t count) : re(padded_size(count)), im(padded_size(count)) {}
  /// Length with the padding.
  std::size_t size() const { return re.size(); }
  std::complex<double> at(std::size_t index) const { return {re[index], im[index]}; }
  void set(std::size_t index, std::complex<double> value) {
    re[index] = value.real();
    im[index] = value.imag();
  }
};

}  // namespace modcal
