// NumPy arrays and what the libraries hold, without copies where the memory allows.
#pragma once

#include <pybind11/numpy.h>

#include <cmath>
#include <span>
#include <vector>

#include "libsim/base/error.hpp"

namespace modcal::python {

namespace py = pybind11;

/// One-dimensional, contiguous, of double precision; others are converted where NumPy can.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

inline std::span<const double> span_of(const Numbers& numbers) {
  return {numbers.data(), static_cast<std::size_t>(numbers.size())};
}

/// A point with so many coordinates, which Python calls `what`. Throws InvalidInput and
/// modcal.InvalidInput, with the sentence for a row of samples, for what is no such row.
inline Numbers point_of(const char* what, const py::object& given, std::size_t size) {
  const bool plain = Py_TYPE(given.ptr()) == py::detail::npy_api::get().PyArray_Type_ &&
                     Numbers::check_(given) && Numbers(given).ndim() == 1;
  const py::object row =
      plain ? given
            : py::module_::import("modcal.records").attr("as_samples")(what, given, "numbers");
  auto numbers = py::reinterpret_borrow<Numbers>(row);
  MODCAL_REQUIRE(numbers.ndim() == 1 && static_cast<std::size_t>(numbers.size()) == size,
                 "{} has {} values: the problem has {} variables, give one for each", what,
                 numbers.size(), size);
  return numbers;
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
