#include "experiments/kinds/benchmark/benchmark.hpp"
#include "experiments/kinds/limit/limit.hpp"
#include "experiments/kinds/schelleng/schelleng.hpp"
#include "experiments/kinds/section7/pluck_then_bow.hpp"
#include "experiments/kinds/simulate/simulate_study.hpp"
#include "experiments/kinds/structure/structure_kinds.hpp"
#include "experiments/kinds/sweep/sweep.hpp"

namespace modcal {

Registry<Experiment> Experiment::registry() {
  static constexpr std::array kTable = {
      entry_of<Experiment, BenchmarkExperiment>(
          "benchmark", "objectives and optimizers on the same truths, noise and starts"),
      kind_of<CalibrateOptions>("calibrate",
                                "refine the modal model, then identify force and motion with it"),
      RegistryEntry<Experiment>{
          "calibration_limit", "calibration error against noise beside the Cramer-Rao bound",
          +[]() -> std::unique_ptr<Recipe<Experiment>> {
            return std::make_unique<CalibrationLimitRecipe>();
          }},
      kind_of<FitModesOptions>("fit_modes",
                               "modes of any structure from a strike that was measured"),
      kind_of<IdentifyOptions>("identify", "modes of a plucked string from its end reactions"),
      kind_of<IdentifyForceOptions>("identify_force",
                                    "force at a contact of any structure from its responses"),
      kind_of<InvertOptions>("invert",
                             "contact force and motion from simulated or recorded reactions"),
      kind_of<PluckThenBowOptions>(
          "pluck_then_bow", "pluck test, law, refinement and contact on a stroke, identification"),
      entry_of<Experiment, SchellengExperiment>(
          "schelleng", "which motion a steady bow stroke settles in, over positions and forces"),
      kind_of<SimulateOptions>("simulate",
                               "a bowed string or a bow on any structure, its signals and figures"),
      entry_of<Experiment, SweepExperiment>(
          "sweep", "the same inversion over axes of settings, summed up in a table"),
  };
  return kTable;
}

}  // namespace modcal
