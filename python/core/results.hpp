// Result of an experiment as Python sees it.
#pragma once

#include <memory>

#include "experiments/study/study.hpp"

namespace modcal::python {

/// Shared: arrays are views of its signals.
struct Outcome {
  StudyResult result;
  double seconds = 0.0;
};

}  // namespace modcal::python
