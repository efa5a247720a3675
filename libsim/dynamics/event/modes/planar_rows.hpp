// Tables of complex numbers, a row after the other, real and imaginary parts apart.
#pragma once

#include <complex>
#include <cstddef>

#include "libsim/base/aligned_vector.hpp"

namespace modcal::event {

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

}  // namespace modcal::event
