#include "libinverse/observer/friction_candidates.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "libinverse/observer/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal::observer {
namespace {

// Between the force at rest and that at the slip speed a hyperbola stays lower at first and falls
// on for longer: it starts with a faster fall and a lower floor.
void start_hyperbolic(ParameterSpace& space, const SlipPicture& slip) {
  BlendedSliding& law = space.start().sliding;
  const double rest = law.at_rest(), fast = law.at(slip.speed).force;
  law.hyperbolic = true;
  law.decay *= 2.0;
  const double left = 1.0 / (1.0 + law.decay * slip.speed);
  law.force_drop = (rest - fast) / (1.0 - left);
  law.dynamic_force = rest - law.force_drop;
  const double least = 0.1 * rest;
  if (law.dynamic_force < least) {
    law.dynamic_force = least;
    law.force_drop = rest - least;
  }
}

// The contact warms to twice the softening temperature while it slides and cools to a fourth of
// that until the string slips again; it starts out cold. Decay is free no more: the force falls
// with the temperature alone.
void start_thermal(ParameterSpace& space, const SlipPicture& slip) {
  BlendedSliding& law = space.start().sliding;
  const double rest = law.at_rest(), fast = law.at(slip.speed).force;
  law.thermal = true;
  law.width = 0.3;
  law.dynamic_force = 0.9 * fast;
  law.force_drop = (rest - law.dynamic_force) / 0.85;
  law.cooling = 1.4 / slip.period;
  law.carried = 0.5 * law.cooling / slip.speed;
  law.heating = 2.0 / (0.5 * (rest + fast) * slip.speed * slip.share * slip.period);
  space.hold(Coordinate::kDecay);
  space.free_also({Coordinate::kHeating, 0, 0.04, 1.5 / 0.04});
  space.free_also({Coordinate::kCooling, 0, 0.06, 1.0 / 0.06});
  space.free_also({Coordinate::kCarried, 0, 0.1, 1.0 / 0.1});
  space.free_also({Coordinate::kWidth, 0, 0.06, 0.7 / 0.06});
}

// Two equal exponentials say nothing about their shares: they start apart.
void start_two_exponential(ParameterSpace& space, const SlipPicture& /*slip*/) {
  BlendedSliding& law = space.start().sliding;
  law.weight = 0.7;
  law.ratio = 0.3;
  law.decay *= 1.3;
  space.free_also({Coordinate::kWeight, 0, 0.05, 0.5 / 0.05});
  space.free_also({Coordinate::kRatio, 0, 0.1, 1.0 / 0.1});
  space.free_also({Coordinate::kViscous, 0, 0.005 * law.at_rest(), 100.0});
}

struct Law {
  std::string_view name;
  // From the exponential one; null: it is this.
  void (*start)(ParameterSpace& space, const SlipPicture& slip) = nullptr;
};
constexpr std::array kLaws = {Law{"exponential"}, Law{"hyperbolic", start_hyperbolic},
                              Law{"thermal", start_thermal},
                              Law{"two_exponential", start_two_exponential}};

}  // namespace

std::vector<std::string_view> friction_law_names() {
  std::vector<std::string_view> names;
  for (const Law& law : kLaws) names.push_back(law.name);
  return names;
}

std::optional<ParameterSpace> with_friction_law(const ParameterSpace& space, std::string_view law,
                                                const SlipPicture& slip) {
  const auto row = std::ranges::find(kLaws, law, &Law::name);
  MODCAL_REQUIRE(row != kLaws.end(), "unknown friction law \"{}\": {} can be compared", law,
                 fmt::join(friction_law_names(), ", "));
  if (row->start == nullptr) return std::nullopt;
  ParameterSpace result = space;
  row->start(result, slip);
  return result;
}

namespace {

// z of the log-likelihood that `best` has ahead of `other`, block by block.
double vuong_distance(const FrictionCandidate& best, const FrictionCandidate& other) {
  std::vector<double> ahead;
  const auto samples = static_cast<double>(2 * kGainBlock);
  for (std::size_t b = 0; b < std::min(best.block_cost.size(), other.block_cost.size()); ++b) {
    ahead.push_back(0.5 * (samples * std::log(other.misfit / best.misfit) +
                           other.block_cost[b] / other.misfit - best.block_cost[b] / best.misfit));
  }
  if (ahead.size() < 2) return 0.0;
  const double spread = standard_deviation(ahead);
  return spread > 0.0 ? std::sqrt(static_cast<double>(ahead.size())) * mean(ahead) / spread : 0.0;
}

}  // namespace

void rank_friction_laws(std::vector<FrictionCandidate>& candidates) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const FrictionCandidate& a, const FrictionCandidate& b) {
                     return a.criterion < b.criterion;
                   });
  for (FrictionCandidate& candidate : candidates) {
    candidate.distance =
        &candidate == candidates.data() ? 0.0 : vuong_distance(candidates.front(), candidate);
  }
  std::size_t named = 0;
  for (std::size_t i = 1; i < candidates.size(); ++i) {
    if (candidates[i].distance < kToldApart &&
        candidates[i].free_parameters < candidates[named].free_parameters) {
      named = i;
    }
  }
  const auto at = candidates.begin() + static_cast<std::ptrdiff_t>(named);
  std::rotate(candidates.begin(), at, at + 1);
}

FrictionCandidate judge_friction_law(const ObserverRuns& runs, const ParameterSpace& space,
                                     std::string_view law, const GainSchedule& schedule) {
  FrictionCandidate candidate{.law = std::string(law)};
  candidate.parameters = space.at(std::vector<double>(space.size(), 0.0));
  candidate.free_parameters = space.size();
  const Innovations innovations =
      runs.innovations(candidate.parameters, schedule, runs.record().samples());
  candidate.misfit = misfit(innovations);
  candidate.block_cost = block_costs(innovations);
  const double count = 2.0 * static_cast<double>(runs.record().samples());
  candidate.criterion = count * std::log(candidate.misfit) +
                        static_cast<double>(candidate.free_parameters) * std::log(count);
  return candidate;
}

std::vector<FrictionCell> friction_curve(std::span<const double> velocity,
                                         std::span<const double> force, double bow_velocity,
                                         std::size_t cells) {
  MODCAL_REQUIRE(
      velocity.size() == force.size() && !velocity.empty(),
      "{} velocities and {} forces: a friction curve needs as many of each, at least one",
      velocity.size(), force.size());
  MODCAL_REQUIRE(cells >= 1, "a friction curve needs at least one cell");
  MODCAL_REQUIRE(bow_velocity != 0.0 && std::isfinite(bow_velocity),
                 "bow velocity {:g} m/s: a resting bow has no direction", bow_velocity);
  const double direction = bow_velocity > 0.0 ? 1.0 : -1.0;
  double largest = 0.0;
  for (const double v : velocity) largest = std::max(largest, direction * (bow_velocity - v));
  std::vector<std::vector<double>> forces(cells);
  for (std::size_t k = 0; k < velocity.size() && largest > 0.0; ++k) {
    const double slip = direction * (bow_velocity - velocity[k]);
    if (slip < kLeastSlipShare * largest) continue;
    const auto cell = static_cast<std::size_t>(slip / largest * static_cast<double>(cells));
    forces[std::min(cell, cells - 1)].push_back(direction * force[k]);
  }
  std::vector<FrictionCell> curve;
  const double width = largest / static_cast<double>(cells);
  for (std::size_t i = 0; i < cells; ++i) {
    if (forces[i].size() < kLeastCellSamples) continue;
    curve.push_back({.speed = (static_cast<double>(i) + 0.5) * width,
                     .median = quantile(forces[i], 0.5),
                     .low = quantile(forces[i], 0.05),
                     .high = quantile(forces[i], 0.95),
                     .samples = forces[i].size()});
  }
  return curve;
}

}  // namespace modcal::observer
