// Friction laws held against each other by what the reactions say.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libinverse/observer/innovation_fit.hpp"

namespace modcal::observer {

/// One law fitted to a record.
struct FrictionCandidate {
  std::string law;  ///< a name of friction_law_names()
  ObserverParameters parameters;
  std::size_t free_parameters = 0;
  double misfit = 0.0;  ///< J under the law's own gains
  /// BIC = N ln J + k ln N over the N innovations of both reactions, up to a constant of the record
  /// (Schwarz, 1978, with unknown scale); the least one is best supported.
  double criterion = 0.0;
  /// z of Vuong's test (1989, Econometrica 57) against the law of the least BIC: Σ_b d_b over √n
  /// sd(d_b), d_b the log-likelihood that the other law has ahead in a block. Below kToldApart the
  /// record does not tell the two apart.
  double distance = 0.0;
  std::vector<double> block_cost;  ///< Σ 2ρ(ν/s) over each block of kGainBlock samples
};

/// Sets the distances and puts the laws in order: the named one first, which is the one with the
/// fewest parameters (then the least BIC) among those that cannot be told from the least BIC, the
/// others by BIC. Bursts in which an observer loses the string differ between fits by more than a
/// BIC forgives; they scatter over the blocks, a better law does not.
void rank_friction_laws(std::vector<FrictionCandidate>& candidates);

/// Names of the laws that can be compared.
std::vector<std::string_view> friction_law_names();

/// The slip as it was seen.
struct SlipPicture {
  double speed = 0.0;   ///< largest slip speed [m/s]
  double period = 0.0;  ///< of the string [s]
  double share = 0.0;   ///< of it that the string slides: x_c/L in Helmholtz motion
};

/// Free parameters of `space`, fitted with the exponential law, carried over to another law: its
/// own shape parameters are freed, the force at rest and at the slip speed stay. None for the
/// exponential law itself. Throws InvalidInput for an unknown name.
std::optional<ParameterSpace> with_friction_law(const ParameterSpace& space, std::string_view law,
                                                const SlipPicture& slip);

/// J and BIC of a law at θ(0) of `space` under the gains that suit it.
FrictionCandidate judge_friction_law(const ObserverRuns& runs, const ParameterSpace& space,
                                     std::string_view law, const GainSchedule& schedule);

/// Force of the samples whose slip speed lies in one cell.
struct FrictionCell {
  double speed = 0.0;   ///< middle of the cell [m/s]
  double median = 0.0;  ///< of the force against the slip [N]
  double low = 0.0;     ///< 5 % quantile [N]
  double high = 0.0;    ///< 95 % quantile [N]
  std::size_t samples = 0;
};

/// Cells of equal width over the sliding samples, v_c against the bow's direction and |v_c| above 2
/// % of the largest slip speed; cells with fewer than 5 samples are left out. velocity v [m/s] and
/// force f_c [N]: equally many samples, bow velocity v_bow ≠ 0 [m/s], cells ≥ 1. Throws
/// InvalidInput otherwise.
std::vector<FrictionCell> friction_curve(std::span<const double> velocity,
                                         std::span<const double> force, double bow_velocity,
                                         std::size_t cells);

}  // namespace modcal::observer
