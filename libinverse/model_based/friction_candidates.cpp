#include "libinverse/model_based/friction_candidates.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal::observer {
namespace {

// Between the force at rest and that at the slip speed a hyperbola stays lower at first and falls
// on for longer: it starts with a faster fall and a lower floor.
void start_hyperbolic(BlendedSliding& law, double slip_speed) {
  const double rest = law.at_rest(), fast = law.at(slip_speed).force;
  law.hyperbolic = true;
  law.decay *= 2.0;
  const double left = 1.0 / (1.0 + law.decay * slip_speed);
  law.force_drop = (rest - fast) / (1.0 - left);
  law.dynamic_force = rest - law.force_drop;
  const double least = 0.1 * rest;
  if (law.dynamic_force < least) {
    law.dynamic_force = least;
    law.force_drop = rest - least;
  }
}

// Two equal exponentials say nothing about their shares: they start apart.
void start_two_exponential(BlendedSliding& law) {
  law.weight = 0.7;
  law.ratio = 0.3;
  law.decay *= 1.3;
}

}  // namespace

std::vector<std::string_view> friction_law_names() {
  return {"exponential", "hyperbolic", "two_exponential"};
}

ParameterSpace with_friction_law(const ParameterSpace& space, std::string_view law,
                                 double slip_speed) {
  ParameterSpace result = space;
  BlendedSliding& sliding = result.start().sliding;
  if (law == "hyperbolic") {
    start_hyperbolic(sliding, slip_speed);
  } else if (law == "two_exponential") {
    start_two_exponential(sliding);
    const double scale = sliding.at_rest();
    result.free_also({Coordinate::kWeight, 0, 0.05, 0.5 / 0.05});
    result.free_also({Coordinate::kRatio, 0, 0.1, 1.0 / 0.1});
    result.free_also({Coordinate::kViscous, 0, 0.005 * scale, 100.0});
  } else {
    MODCAL_REQUIRE(law == "exponential",
                   "unknown friction law \"{}\": exponential, hyperbolic and two_exponential can "
                   "be compared",
                   law);
  }
  return result;
}

FrictionCandidate judge_friction_law(const ObserverRuns& runs, const ParameterSpace& space,
                                     std::string_view law, const GainSchedule& schedule) {
  FrictionCandidate candidate{.law = std::string(law)};
  candidate.parameters = space.at(std::vector<double>(space.size(), 0.0));
  candidate.free_parameters = space.size();
  candidate.misfit =
      misfit(runs.innovations(candidate.parameters, schedule, runs.record().samples()));
  const double count = 2.0 * static_cast<double>(runs.record().samples());
  candidate.criterion = count * std::log(candidate.misfit) +
                        static_cast<double>(candidate.free_parameters) * std::log(count);
  return candidate;
}

}  // namespace modcal::observer
