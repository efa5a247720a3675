// Every optimizer with every algorithm it offers, and the digits it promises.
#pragma once

#include <algorithm>
#include <cctype>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "libcalib/optimizers/ceres_optimizer.hpp"
#include "libcalib/optimizers/gsl_optimizer.hpp"
#include "libcalib/optimizers/nlopt_optimizer.hpp"
#include "libcalib/optimizers/staged/staged.hpp"
#include "libcalib/optimizers/systematic_search.hpp"
#include "libcalib/optimizers/tiny_least_squares.hpp"

namespace modcal {

/// How an optimizer gets to a minimum, which decides what can be promised.
enum class Way {
  kSystematic,    ///< points laid out beforehand
  kGlobal,        ///< the whole box, ends near the minimum
  kSimplex,       ///< local, values only
  kGradient,      ///< local, with slopes
  kLeastSquares,  ///< local, residuals with their Jacobian
  kLine,          ///< one variable only
};

struct OptimizerCase {
  std::string label;
  Way way;
  std::shared_ptr<const Optimizer> optimizer;
};

inline void PrintTo(const OptimizerCase& entry, std::ostream* stream) { *stream << entry.label; }

inline Way way_of(std::string_view nlopt_algorithm) {
  if (nlopt_algorithm.starts_with("G")) return Way::kGlobal;
  return nlopt_algorithm.starts_with("LD") ? Way::kGradient : Way::kSimplex;
}

inline Way way_of(const GslOptimizer& optimizer, const std::string& algorithm) {
  if (optimizer.needs().least_squares) return Way::kLeastSquares;
  if (optimizer.needs().gradient) return Way::kGradient;
  return algorithm.starts_with("nmsimplex") ? Way::kSimplex : Way::kLine;
}

/// All of them; every name of the registry is there.
inline std::vector<OptimizerCase> optimizer_cases() {
  std::vector<OptimizerCase> cases;
  const auto add = [&cases](std::string label, Way way, auto optimizer) {
    cases.push_back(
        {std::move(label), way, std::make_shared<decltype(optimizer)>(std::move(optimizer))});
  };
  for (const auto algorithm : GslOptimizer::algorithms()) {
    const std::string name(algorithm);
    const GslOptimizer optimizer({.algorithm = name});
    add("gsl_" + name, way_of(optimizer, name), optimizer);
  }
  for (const auto algorithm : NloptOptimizer::algorithms()) {
    const std::string name(algorithm);
    add("nlopt_" + name, way_of(algorithm), NloptOptimizer({.algorithm = name}));
  }
  for (const std::string strategy : {"levenberg_marquardt", "dogleg", "subspace_dogleg"}) {
    add("ceres_" + strategy, Way::kLeastSquares, CeresOptimizer({.strategy = strategy}));
  }
  for (const std::string direction : {"bfgs", "lbfgs", "fletcher_reeves", "polak_ribiere",
                                      "hestenes_stiefel", "steepest_descent"}) {
    add("ceres_line_search_" + direction, Way::kGradient,
        CeresLineSearch({.direction = direction}));
  }
  Staged::Stage whole;
  whole.optimizer.select("ceres");
  add("staged", Way::kLeastSquares, Staged({.stages = {whole}}));
  add("tiny_least_squares", Way::kLeastSquares, TinyLeastSquares(TinyLeastSquares::Options{}));
  add("grid", Way::kSystematic, Grid(Grid::Options{}));
  add("mode_by_mode", Way::kSystematic, ModeByMode(ModeByMode::Options{}));
  return cases;
}

}  // namespace modcal
