// Long work beside Python: the interpreter's lock is let go, Ctrl-C stops the work.
#pragma once

#include <pybind11/functional.h>
#include <pybind11/pybind11.h>

#include <atomic>
#include <functional>

namespace modcal::python {

namespace py = pybind11;

/// What work is handed.
struct Watch {
  const std::atomic<bool>& stop;
  std::function<void(double)> progress;  ///< takes the share done, from any thread
};

/// Does the work in a thread of its own and waits for it. Between times Python sees its signals and
/// `progress(share)` is called, unless it is None, and progress(1) at a good end, however short the
/// work was. What either raises stops the work and is raised when it has ended; else what the work
/// throws.
void do_watched(const py::object& progress, const std::function<void(const Watch&)>& work);

/// With a result.
template <typename Work>
auto watched(const py::object& progress, const Work& work) {
  std::optional<decltype(work(std::declval<const Watch&>()))> result;
  do_watched(progress, [&](const Watch& watch) { result.emplace(work(watch)); });
  return std::move(*result);
}

}  // namespace modcal::python
