#include "python/core/errors.hpp"

#include <pybind11/pybind11.h>

#include "libsim/base/files.hpp"

namespace modcal::python {
namespace {

namespace py = pybind11;

py::object mistake_of(const Complaint& complaint) {
  const InputPlace& place = complaint.place;
  const auto number = [](std::size_t value) { return value > 0 ? py::cast(value) : py::none(); };
  const std::string& path = place.option.empty() ? place.file : place.option;
  return py::module_::import("modcal.errors")
      .attr("Mistake")(complaint.text, path.empty() ? py::object(py::none()) : py::cast(path),
                       number(place.line), number(place.column),
                       complaint.grade == Complaint::Grade::kWarning, complaint.source);
}

void raise(const std::vector<Complaint>& complaints) {
  py::list mistakes;
  for (const Complaint& complaint : complaints) mistakes.append(mistake_of(complaint));
  const py::object type = py::module_::import("modcal.errors").attr("InvalidInput");
  PyErr_SetObject(type.ptr(), type(mistakes).ptr());
}

void translate(std::exception_ptr error) {
  try {
    std::rethrow_exception(std::move(error));
  } catch (const Refusal& refusal) {
    raise(refusal.complaints());
  } catch (const InvalidInput& invalid) {
    raise({complaint_of(invalid)});
  } catch (const Interrupted&) {
    PyErr_SetNone(PyExc_KeyboardInterrupt);
  } catch (const LostOutput& lost) {
    PyErr_SetString(PyExc_OSError, lost.what());
  }
}

}  // namespace

void translate_errors() { py::register_exception_translator(&translate); }

}  // namespace modcal::python
