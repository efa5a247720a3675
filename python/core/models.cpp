// Modal models: a string by its keys, or any structure by its table.
#include <pybind11/complex.h>
#include <pybind11/stl.h>

#include <numbers>

#include "experiments/kinds/structure/structure_files.hpp"
#include "libsim/model/transfer.hpp"
#include "libsim/records/recording.hpp"
#include "python/core/arrays.hpp"
#include "python/core/errors.hpp"
#include "python/core/module.hpp"

namespace modcal::python {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

struct Model {
  ModalModel modes;
  std::vector<std::string> names;

  // Keys "string" and "bow" of an experiment; recorded: modes above those stated answer, too.
  static Model of_string(const std::string& yaml, bool recorded) {
    StringModel string;
    ContactOptions contact;
    read_keys(yaml, [&](OptionVisitor& visitor) {
      visitor("string", "the string", string);
      visitor("bow", "where the force acts", contact);
    });
    return {string_model(make_modal_basis(string), contact.position, {.remainder = recorded}),
            {"R1", "R2", "y"}};
  }
  static Model of_table(const std::string& path) {
    StructureTable table = read_table(path);
    return {std::move(table.model), std::move(table.names)};
  }

  py::array frequencies() const {
    std::vector<double> hertz;
    for (const ModalPole& pole : modes.poles) hertz.push_back(pole.omega / kTurn);
    return array_of(std::move(hertz));
  }
  py::array damping_ratios() const {
    std::vector<double> ratios;
    for (const ModalPole& pole : modes.poles) ratios.push_back(pole.zeta);
    return array_of(std::move(ratios));
  }
  std::vector<std::string_view> kinds() const {
    std::vector<std::string_view> kinds;
    for (const SensorKind kind : modes.sensors) kinds.push_back(name_of(kind));
    return kinds;
  }
  py::array_t<Complex> constants() const {
    py::array_t<Complex> all({modes.sensors.size(), modes.poles.size()});
    for (std::size_t i = 0; i < modes.constants.size(); ++i) {
      all.mutable_data()[i] = {modes.constants[i],
                               modes.quadrature.empty() ? 0.0 : modes.quadrature[i]};
    }
    return all;
  }
  // One sum a frequency, so that they need not be even.
  py::array_t<Complex> transfer(const Numbers& hertz) const {
    const std::span<const double> at = span_of(hertz);
    py::array_t<Complex> all({modes.sensors.size(), at.size()});
    const ModalSums sums(modes);
    SplitSpectra one;
    one.resize(sums.rows(), 1);
    for (std::size_t i = 0; i < at.size(); ++i) {
      MODCAL_REQUIRE(at[i] >= 0.0 && std::isfinite(at[i]),
                     "frequency {} is {:g} Hz; give frequencies from 0 on", i, at[i]);
      sums.evaluate({.spacing = kTurn * at[i], .bins = 2}, {1, 2}, 0, one);
      for (std::size_t k = 0; k < modes.sensors.size(); ++k) {
        all.mutable_at(k, i) = one.at(k, 0);
      }
    }
    return all;
  }
};

}  // namespace

void add_models(py::module_& module) {
  py::class_<Model>(module, "ModalModel")
      .def_static("of_string", &Model::of_string, py::arg("options"), py::arg("recorded"))
      .def_static("of_table", &Model::of_table, py::arg("path"))
      .def_readonly("sensors", &Model::names)
      .def_property_readonly("kinds", &Model::kinds)
      .def_property_readonly("frequencies", &Model::frequencies)
      .def_property_readonly("damping_ratios", &Model::damping_ratios)
      .def_property_readonly("constants", &Model::constants)
      .def("transfer", &Model::transfer, py::arg("frequencies"));
}

}  // namespace modcal::python
