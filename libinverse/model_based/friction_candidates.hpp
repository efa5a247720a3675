// Friction laws held against each other by what the reactions say.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "libinverse/model_based/innovation_fit.hpp"

namespace modcal::observer {

/// One law fitted to a record.
struct FrictionCandidate {
  std::string law;  ///< "exponential", "hyperbolic" or "two_exponential"
  ObserverParameters parameters;
  std::size_t free_parameters = 0;
  double misfit = 0.0;  ///< J under the law's own gains
  /// BIC = N ln J + k ln N over the N innovations of both reactions, up to a constant of the record
  /// (Schwarz, 1978, with unknown scale); the least one is best supported.
  double criterion = 0.0;
};

/// Names of the laws that can be compared.
std::vector<std::string_view> friction_law_names();

/// Free parameters of `space`, fitted with the exponential law, carried over to another law: its
/// own shape parameters are freed, the force at rest and at `slip_speed` [m/s] stay. Throws
/// InvalidInput for an unknown name.
ParameterSpace with_friction_law(const ParameterSpace& space, std::string_view law,
                                 double slip_speed);

/// J and BIC of a law at θ(0) of `space` under the gains that suit it.
FrictionCandidate judge_friction_law(const ObserverRuns& runs, const ParameterSpace& space,
                                     std::string_view law, const GainSchedule& schedule);

}  // namespace modcal::observer
