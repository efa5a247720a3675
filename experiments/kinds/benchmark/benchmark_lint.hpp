// Fairness of a benchmark: what would reward a method for something else than being good.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "experiments/experiment.hpp"
#include "experiments/kinds/calibrate/calibrate_study.hpp"

namespace modcal {

/// A task by what is compared.
struct FairnessTask {
  std::size_t task = 0;
  std::string method, condition, replicate;
};

using CellOptions = std::function<CalibrateOptions(std::size_t task)>;

/// Warnings where methods have different budgets, bounds, starts, noise or problems, where there
/// are fewer than 10 draws to rank them by, and where a search does not come half the way to the
/// minimum of a parabola of as many variables within its budget, though it could with twenty times
/// as much.
std::vector<Finding> lint_fairness(const std::vector<FairnessTask>& tasks,
                                   const CellOptions& options_of);

}  // namespace modcal
