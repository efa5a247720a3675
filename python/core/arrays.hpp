// NumPy arrays and what the libraries hold, without copies where the memory allows.
#pragma once

#include <pybind11/numpy.h>

#include <span>
#include <vector>

namespace modcal::python {

namespace py = pybind11;

/// One-dimensional, contiguous, of double precision; others are converted where NumPy can.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

inline std::span<const double> span_of(const Numbers& numbers) {
  return {numbers.data(), static_cast<std::size_t>(numbers.size())};
}

/// The samples themselves: they live as long as `owner`.
inline py::array view_of(const std::vector<double>& samples, const py::object& owner) {
  return py::array_t<double>(static_cast<py::ssize_t>(samples.size()), samples.data(), owner);
}

/// An array that takes the vector over.
inline py::array array_of(std::vector<double> samples) {
  auto* kept = new std::vector<double>(std::move(samples));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<double>*>(p); });
  return view_of(*kept, owner);
}

}  // namespace modcal::python
