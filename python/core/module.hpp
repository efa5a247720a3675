// The parts of modcal._core, each in a file of its own.
#pragma once

#include <pybind11/pybind11.h>

namespace modcal::python {

namespace py = pybind11;

void add_experiments(py::module_& module);
void add_results(py::module_& module);
void add_searches(py::module_& module);
void add_models(py::module_& module);
void add_inversions(py::module_& module);
void add_own_objectives(py::module_& module);
void add_own_searches(py::module_& module);

}  // namespace modcal::python
