#include "libinverse/observer/parameter_space.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "libinverse/observer/friction_candidates.hpp"

namespace modcal::observer {
namespace {

using Parameters = ObserverParameters;

// How a number follows its coordinate: times exp(change), plus the change, the same within [0, 1].
enum class Moved { kByFactor, kBySum, kWithinOne };

struct Row {
  Moved moved;
  double* (*number)(Parameters& parameters, std::size_t index);
};

// By Coordinate, in its order.
constexpr Row kRows[] = {
    {Moved::kByFactor, [](Parameters& p, std::size_t) { return &p.sliding.dynamic_force; }},
    {Moved::kByFactor, [](Parameters& p, std::size_t) { return &p.sliding.force_drop; }},
    {Moved::kByFactor, [](Parameters& p, std::size_t) { return &p.sliding.decay; }},
    {Moved::kByFactor, [](Parameters& p, std::size_t) { return &p.bow_velocity; }},
    {Moved::kByFactor, [](Parameters& p, std::size_t) { return &p.stiffness; }},
    {Moved::kBySum, [](Parameters& p, std::size_t) { return &p.offset[0]; }},
    {Moved::kBySum, [](Parameters& p, std::size_t) { return &p.offset[1]; }},
    {Moved::kByFactor, [](Parameters& p, std::size_t) { return &p.damping_ratio; }},
    {Moved::kWithinOne, [](Parameters& p, std::size_t) { return &p.sliding.weight; }},
    {Moved::kByFactor, [](Parameters& p, std::size_t) { return &p.sliding.ratio; }},
    {Moved::kBySum, [](Parameters& p, std::size_t) { return &p.sliding.viscous; }},
    {Moved::kByFactor, [](Parameters& p, std::size_t) { return &p.sliding.heating; }},
    {Moved::kByFactor, [](Parameters& p, std::size_t) { return &p.sliding.cooling; }},
    {Moved::kByFactor, [](Parameters& p, std::size_t) { return &p.sliding.carried; }},
    {Moved::kByFactor, [](Parameters& p, std::size_t) { return &p.sliding.width; }},
    {Moved::kBySum, [](Parameters& p, std::size_t i) { return &p.force_knots[i]; }},
    {Moved::kBySum, [](Parameters& p, std::size_t i) { return &p.velocity_knots[i]; }},
    {Moved::kBySum, [](Parameters& p, std::size_t) { return &p.delay; }},
    {Moved::kByFactor, [](Parameters& p, std::size_t) { return &p.gain; }},
    {Moved::kBySum, [](Parameters& p, std::size_t) { return &p.contact; }},
    {Moved::kBySum, [](Parameters& p, std::size_t i) { return &p.detuning[i]; }},
};
static_assert(std::size(kRows) == static_cast<std::size_t>(Coordinate::kDetuning) + 1);

void move(ObserverParameters& parameters, const FreeParameter& free, double amount) {
  const double change = free.step * amount;
  const Row& row = kRows[static_cast<std::size_t>(free.coordinate)];
  double& number = *row.number(parameters, free.index);
  number = row.moved == Moved::kByFactor ? number * std::exp(change) : number + change;
  if (row.moved == Moved::kWithinOne) number = std::clamp(number, 0.0, 1.0);
}

}  // namespace

ObserverParameters ParameterSpace::at(std::span<const double> x) const {
  ObserverParameters result = start_;
  for (std::size_t i = 0; i < free_.size(); ++i) move(result, free_[i], x[i]);
  return result;
}

double ParameterSpace::penalty(std::span<const double> x) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    if (std::isinf(free_[i].prior)) continue;
    const double moved = (x[i] - free_[i].center) / free_[i].prior;
    sum += 0.5 * moved * moved;
  }
  return sum;
}

ParameterSpace ParameterSpace::restarted_at(std::span<const double> x) const {
  ParameterSpace result(at(x), free_);
  for (std::size_t i = 0; i < free_.size(); ++i) result.free_[i].center -= x[i];
  return result;
}

std::vector<FreeParameter> basic_parameters(double force_scale,
                                            const double (&offset_deviation)[2]) {
  const double step = 2.5e-3 * force_scale;
  return {{Coordinate::kDynamicForce, 0, 0.01},
          {Coordinate::kForceDrop, 0, 0.02},
          {Coordinate::kDecay, 0, 0.04},
          {Coordinate::kBowVelocity, 0, 0.01},
          {Coordinate::kStiffness, 0, 0.08},
          {Coordinate::kLeftOffset, 0, step, offset_deviation[0] / step},
          {Coordinate::kRightOffset, 0, step, offset_deviation[1] / step}};
}

void ModelBasedOptions::visit(OptionVisitor& visitor) {
  visitor("laws", "friction laws to fit; of several the best supported one is taken",
          {.choices = friction_law_names()}, laws);
  visitor("substeps", "steps of the observer per sample", {.range = Range::closed(1, 64)},
          substeps);
  visitor("rounds", "rounds of gain search and fit", {.range = Range::closed(0, 20)}, rounds);
  visitor("adherence_damping", "fit the damping of adherence, else critical", adherence_damping);
  visitor("force_knots", "knots of the normal force in time; 0: constant",
          {.range = Range::closed(0, 200)}, force_knots);
  visitor("velocity_knots", "knots of the bow velocity in time; 0: constant",
          {.range = Range::closed(0, 200)}, velocity_knots);
  visitor("delay", "fit the delay between the two sensors", delay);
  visitor("gain", "fit the gain ratio of the two sensors", gain);
  visitor("contact", "fit the contact point", contact);
  visitor("frequencies", "fit every modal frequency", frequencies);
  visitor("misfit_limit",
          "innovation misfit, median over blocks, above which the result warns; "
          "auto: by its sampling deviation",
          {.range = Range::positive(), .word = "auto"}, misfit_limit);
  for (std::size_t r = 0; r < 2; ++r) {
    visitor(r == 0 ? "noise_rms_1" : "noise_rms_2",
            r == 0 ? "noise of one sample of the reaction at x = 0"
                   : "noise of one sample of the reaction at x = L",
            {.unit = "N", .range = Range::positive(), .word = "measured"}, noise_rms[r]);
  }
}

void free_more(const ModelBasedOptions& options, std::span<const std::size_t> modes,
               ParameterSpace& space) {
  ObserverParameters& start = space.start();
  const auto free = [&](Coordinate coordinate, std::size_t index, double step, double prior) {
    space.free_also({coordinate, index, step, prior / step});
  };
  if (options.adherence_damping) free(Coordinate::kDamping, 0, 0.08, 2.0);
  const auto free_knots = [&](Coordinate coordinate, std::int64_t count, double step,
                              std::vector<double>& knots) {
    knots.assign(static_cast<std::size_t>(count), 0.0);
    for (std::size_t i = 0; i < knots.size(); ++i) free(coordinate, i, step, 0.3);
  };
  free_knots(Coordinate::kForceKnot, options.force_knots, 0.02, start.force_knots);
  free_knots(Coordinate::kVelocityKnot, options.velocity_knots, 0.01, start.velocity_knots);
  if (options.delay) free(Coordinate::kDelay, 0, 1e-6, 1e-4);
  if (options.gain) free(Coordinate::kGain, 0, 0.01, 0.3);
  if (options.contact) free(Coordinate::kContact, 0, 3e-4 * start.contact, 0.1 * start.contact);
  if (options.frequencies) {
    start.detuning.assign(modes.empty() ? 0 : modes.back() + 1, 0.0);
    for (const std::size_t n : modes) free(Coordinate::kDetuning, n, 1e-5, 1e-3);
  }
}

}  // namespace modcal::observer
