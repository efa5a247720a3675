#include "python/core/module.hpp"

#include "python/core/errors.hpp"

PYBIND11_MODULE(_core, module) {
  module.doc() =
      "The engine of modcal. Use the package modcal, which says the same in Python's words.";
  modcal::python::translate_errors();
  // A class before what returns it, whose signature names it.
  modcal::python::add_results(module);
  modcal::python::add_models(module);
  modcal::python::add_searches(module);
  modcal::python::add_experiments(module);
  modcal::python::add_inversions(module);
  modcal::python::add_own_searches(module);
  modcal::python::add_own_objectives(module);
}
