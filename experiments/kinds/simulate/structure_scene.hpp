// The scene of `simulate` with a table of modes in the place of the string.
#pragma once

#include <filesystem>

#include "experiments/experiment.hpp"
#include "libinverse/structure/structure_table.hpp"
#include "libsim/dynamics/scene/driven_structure.hpp"
#include "libsim/signal/measurement.hpp"

namespace modcal {

/// A bow, or whatever slides on it, at the contact of any structure.
struct StructureSceneOptions {
  std::string table;
  std::string contact;  ///< the sensor that reads there; empty: the table tells
  Bow bow;              ///< its place and width do not count
  Choice<FrictionLaw> friction{"coulomb_exponential"};
  double duration = 1.0;  ///< [s]
  double rest = 0.01;     ///< of it, before the bow touches [s]
  std::int64_t oversampling = 8;
  void visit(OptionVisitor& visitor);

  /// What follows the rest, as the recorder at `sample_rate` [Hz] needs it; the structure is for
  /// simulate_structure() to set.
  Scene scene(double sample_rate) const;
  /// At which the scene is simulated [Hz].
  double fine_rate(double sample_rate) const {
    return sample_rate * static_cast<double>(oversampling);
  }
  /// The record of a signal that was simulated so: rest, anti-alias filter, sample rate.
  std::vector<double> recorded(const std::vector<double>& fine, double sample_rate) const;
  /// What is simulated of a table: modes without the static terms that differentiate the force.
  /// Throws WrongKey where it does not tell how the contact moves.
  DrivenStructure driven(const StructureTable& told) const;

  /// The file of its modes, with what its simulation holds.
  FileRead file_read(double sample_rate) const;

  std::vector<Finding> lint(const Choice<Simulator>& simulator,
                            const Measurement& measurement) const;
  /// What the table says against them; reads it.
  std::vector<Finding> lint_table(const std::filesystem::path& folder,
                                  const Choice<Simulator>& simulator,
                                  const Measurement& measurement) const;
};

}  // namespace modcal
