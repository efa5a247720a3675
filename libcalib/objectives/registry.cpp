#include "libcalib/objectives/force_difference.hpp"
#include "libcalib/objectives/frequency_prior.hpp"
#include "libcalib/objectives/innovation_misfit.hpp"
#include "libcalib/objectives/joint_likelihood.hpp"
#include "libcalib/objectives/smooth_spectral_peak.hpp"
#include "libcalib/objectives/spectral_peak.hpp"
#include "libcalib/objectives/weighted_sum.hpp"
#include "libsim/base/registry_table.hpp"

namespace modcal {
namespace {

RegistryTable<Objective>& objective_table() {
  static RegistryTable<Objective> rows = {
      entry_of<Objective, ContactLocation>(
          "contact_location", "relative difference of the two identified force waveforms"),
      entry_of<Objective, ContactLocationSquares>(
          "contact_location_squares", "smooth variant of contact_location, as residuals"),
      entry_of<Objective, ForceMismatch>("force_mismatch",
                                         "least squares of the two identified force spectra"),
      entry_of<Objective, FrequencyPrior>(
          "frequency_prior", "modal frequencies measured otherwise, with their deviations"),
      entry_of<Objective, InnovationMisfit>(
          "innovation_misfit", "what an observer with a fitted friction law fails to predict"),
      entry_of<Objective, JointLikelihood>(
          "joint_likelihood", "both reactions compared with the force eliminated in every bin"),
      entry_of<Objective, SmoothSpectralPeak>("smooth_spectral_peak",
                                              "smooth variant of spectral_peak, as residuals"),
      entry_of<Objective, SpectralPeak>("spectral_peak",
                                        "the paper's integral of the force spectrum over a band"),
      entry_of<Objective, WeightedSum>("weighted_sum", "a weighted sum of other objectives"),
  };
  return rows;
}

}  // namespace

Registry<Objective> Objective::registry() { return objective_table().rows(); }

void Objective::add(std::string name, std::string summary,
                    std::shared_ptr<const Objective> product) {
  objective_table().add(std::move(name), std::move(summary), std::move(product));
}

}  // namespace modcal
