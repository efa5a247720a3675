// Modal models: a string by its keys, or any structure by its table.
#include "python/core/models.hpp"

#include <fmt/ranges.h>
#include <pybind11/complex.h>
#include <pybind11/stl.h>

#include "experiments/kinds/structure/structure_files.hpp"
#include "libinverse/structure/strikes/strike_fit.hpp"
#include "libsim/base/turn.hpp"
#include "libsim/model/transfer.hpp"
#include "libsim/records/recording.hpp"
#include "python/core/errors.hpp"
#include "python/core/module.hpp"
#include "python/core/watched.hpp"

namespace modcal::python {
namespace {

// The table of the modes of measured responses, K × lines from 0 Hz on.
std::string fit_response(double step, const py::array_t<Complex, py::array::c_style>& responses,
                         const std::vector<std::string>& names,
                         const std::vector<std::string>& kinds, double low, double high,
                         std::size_t most_modes) {
  const auto lines = static_cast<std::size_t>(responses.shape(1));
  MeasuredFunctions measured{.grid = {.spacing = kTurn * step, .bins = lines}};
  Transfers& rows = measured.sessions.emplace_back();
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Complex* const row = responses.data() + k * lines;
    rows.emplace_back(row, row + lines);
    measured.sensors.push_back(kind_of_sensor(names[k], kinds[k]));
  }
  return watched(py::none(), [&](const Watch&) {
    StrikeFit fit =
        modcal::fit_response(measured, {.low = low, .high = high, .most_modes = most_modes});
    if (const std::string why = fit.rejection(); !why.empty()) throw_invalid_input("{}", why);
    fit.table.names = names;
    return table_text(fit.table);
  });
}

}  // namespace

SensorKind kind_of_sensor(const std::string& name, const std::string& kind) {
  MODCAL_REQUIRE(std::ranges::count(sensor_kind_names(), kind) > 0,
                 "channel {} cannot read \"{}\": {}", name, kind,
                 fmt::join(sensor_kind_names(), ", "));
  return sensor_kind_of(kind);
}

Model Model::of_basis(const ModalBasis& basis, double contact, bool recorded) {
  return {string_model(basis, contact, {.remainder = recorded}), {"R1", "R2", "y"}};
}

Model Model::of_string(const std::string& yaml, bool recorded) {
  StringModel string;
  ContactOptions contact;
  read_keys(yaml, [&](OptionVisitor& visitor) {
    visitor("string", "the string", string);
    visitor("bow", "where the force acts", contact);
  });
  return of_basis(make_modal_basis(string), contact.position, recorded);
}

Model Model::of_table(const std::string& path) {
  StructureTable table = read_table(path);
  table.require_modes("a Model");
  return {std::move(table.model), std::move(table.names)};
}

py::array Model::frequencies() const {
  std::vector<double> hertz;
  for (const ModalPole& pole : modes.poles) hertz.push_back(pole.omega / kTurn);
  return array_of(std::move(hertz));
}

py::array Model::damping_ratios() const {
  std::vector<double> ratios;
  for (const ModalPole& pole : modes.poles) ratios.push_back(pole.zeta);
  return array_of(std::move(ratios));
}

std::vector<std::string_view> Model::kinds() const {
  std::vector<std::string_view> kinds;
  for (const SensorKind kind : modes.sensors) kinds.push_back(name_of(kind));
  return kinds;
}

py::array_t<Complex> Model::constants() const {
  py::array_t<Complex> all({modes.sensors.size(), modes.poles.size()});
  for (std::size_t i = 0; i < modes.constants.size(); ++i) {
    all.mutable_data()[i] = {modes.constants[i],
                             modes.quadrature.empty() ? 0.0 : modes.quadrature[i]};
  }
  return all;
}

py::array_t<Complex> Model::transfer(const Numbers& hertz) const {
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

void add_models(py::module_& module) {
  module.def("fit_response", &fit_response, py::arg("step"), py::arg("responses"), py::arg("names"),
             py::arg("kinds"), py::arg("low"), py::arg("high"), py::arg("most_modes"));
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
