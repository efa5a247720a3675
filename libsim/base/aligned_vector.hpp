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
/// Fixed by: 512 bits of the widest instruction set.
inline constexpr std::size_t kVectorPadding = 8;

constexpr std::size_t padded_size(std::size_t size) {
  return (size + kVectorPadding - 1) / kVectorPadding * kVectorPadding;
}

/// value(n) for n < size, then the filling up to whole vectors.
template <typename Value>
AlignedVector padded(std::size_t size, double filling, Value value) {
  AlignedVector result(padded_size(size), filling);
  for (std::size_t n = 0; n < size; ++n) result[n] = value(n);
  return result;
}

inline AlignedVector padded(const std::vector<double>& values) {
  return padded(values.size(), 0.0, [&values](std::size_t n) { return values[n]; });
}

/// Complex numbers with real and imaginary parts apart, padded with zeros to whole vectors.
struct PlanarVector {
  AlignedVector re, im;

  PlanarVector() = default;
  explicit PlanarVector(std::size_t count) : re(padded_size(count)), im(padded_size(count)) {}
  explicit PlanarVector(const std::vector<std::complex<double>>& values)
      : PlanarVector(values.size()) {
    for (std::size_t n = 0; n < values.size(); ++n) set(n, values[n]);
  }
  /// Length with the padding.
  std::size_t size() const { return re.size(); }
  std::complex<double> at(std::size_t index) const { return {re[index], im[index]}; }
  void set(std::size_t index, std::complex<double> value) {
    re[index] = value.real();
    im[index] = value.imag();
  }
};

/// Tables of `count` planar rows of one length behind each other.
struct PlanarRows {
  std::size_t count = 0;
  std::size_t size = 0;
  AlignedVector data;

  PlanarRows() = default;
  PlanarRows(std::size_t rows, std::size_t columns)
      : count(rows), size(padded_size(columns)), data(2 * rows * size) {}
  double* re(std::size_t row) { return data.data() + 2 * row * size; }
  double* im(std::size_t row) { return re(row) + size; }
  const double* re(std::size_t row) const { return data.data() + 2 * row * size; }
  const double* im(std::size_t row) const { return re(row) + size; }
  void set(std::size_t row, std::size_t column, std::complex<double> value) {
    re(row)[column] = value.real();
    im(row)[column] = value.imag();
  }
};

}  // namespace modcal
