// A modal model with the names of its sensors.
#pragma once

#include "libsim/model/modal_basis.hpp"
#include "libsim/model/modal_model.hpp"
#include "python/core/arrays.hpp"

namespace modcal::python {

struct Model {
  ModalModel modes;
  std::vector<std::string> names;

  /// Of the reactions and the displacement at the contact. recorded: modes above those of the basis
  /// answer, too.
  static Model of_basis(const ModalBasis& basis, double contact, bool recorded);
  /// Keys "string" and "bow" of an experiment.
  static Model of_string(const std::string& yaml, bool recorded);
  /// A file as fit_modes leaves it.
  static Model of_table(const std::string& path);

  py::array frequencies() const;
  py::array damping_ratios() const;
  std::vector<std::string_view> kinds() const;
  py::array_t<Complex> constants() const;
  /// One sum a frequency, so that they need not be even.
  py::array_t<Complex> transfer(const Numbers& hertz) const;
};

/// Throws InvalidInput for what no sensor reads.
SensorKind kind_of_sensor(const std::string& name, const std::string& kind);

}  // namespace modcal::python
