#include "libcalib/optimizers/ceres_optimizer.hpp"
#include "libcalib/optimizers/gsl_optimizer.hpp"
#include "libcalib/optimizers/nlopt_optimizer.hpp"
#include "libcalib/optimizers/scoring.hpp"
#include "libcalib/optimizers/staged/staged.hpp"
#include "libcalib/optimizers/systematic_search.hpp"
#include "libcalib/optimizers/tiny_least_squares.hpp"
#include "libsim/base/registry_table.hpp"

namespace modcal {
namespace {

RegistryTable<Optimizer>& optimizer_table() {
  static RegistryTable<Optimizer> rows = {
      entry_of<Optimizer, CeresOptimizer>("ceres", "trust-region least squares of Ceres Solver"),
      entry_of<Optimizer, CeresLineSearch>("ceres_line_search",
                                           "quasi-Newton line search of Ceres Solver"),
      entry_of<Optimizer, Grid>("grid", "every point of a regular grid, for few parameters"),
      entry_of<Optimizer, GslOptimizer>("gsl", "an algorithm of the GNU Scientific Library"),
      entry_of<Optimizer, ModeByMode>(
          "mode_by_mode", "the paper's systematic search, one parameter after the other"),
      entry_of<Optimizer, NloptOptimizer>("nlopt", "an algorithm of NLopt, by its name"),
      entry_of<Optimizer, Scoring>(
          "scoring", "Fisher scoring: Newton steps by the information of a likelihood"),
      entry_of<Optimizer, Staged>("staged",
                                  "stages on damped and whole records, by default the objective's "
                                  "own schedule to the bound"),
      entry_of<Optimizer, TinyLeastSquares>("tiny_least_squares",
                                            "least squares for few parameters, without allocation"),
  };
  return rows;
}

}  // namespace

Registry<Optimizer> Optimizer::registry() { return optimizer_table().rows(); }

void Optimizer::add(std::string name, std::string summary,
                    std::shared_ptr<const Optimizer> product) {
  optimizer_table().add(std::move(name), std::move(summary), std::move(product));
}

}  // namespace modcal
