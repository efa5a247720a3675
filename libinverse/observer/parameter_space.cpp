#include "libinverse/observer/parameter_space.hpp"

#include <algorithm>
#include <cmath>

namespace modcal::observer {
namespace {

void move(ObserverParameters& p, const FreeParameter& free, double amount) {
  const double change = free.step * amount;
  switch (free.coordinate) {
    case Coordinate::kDynamicForce:
      p.sliding.dynamic_force *= std::exp(change);
      break;
    case Coordinate::kForceDrop:
      p.sliding.force_drop *= std::exp(change);
      break;
    case Coordinate::kDecay:
      p.sliding.decay *= std::exp(change);
      break;
    case Coordinate::kBowVelocity:
      p.bow_velocity *= std::exp(change);
      break;
    case Coordinate::kStiffness:
      p.stiffness *= std::exp(change);
      break;
    case Coordinate::kLeftOffset:
      p.offset[0] += change;
      break;
    case Coordinate::kRightOffset:
      p.offset[1] += change;
      break;
    case Coordinate::kDamping:
      p.damping_ratio *= std::exp(change);
      break;
    case Coordinate::kWeight:
      p.sliding.weight = std::clamp(p.sliding.weight + change, 0.0, 1.0);
      break;
    case Coordinate::kRatio:
      p.sliding.ratio *= std::exp(change);
      break;
    case Coordinate::kViscous:
      p.sliding.viscous += change;
      break;
    case Coordinate::kHeating:
      p.sliding.heating *= std::exp(change);
      break;
    case Coordinate::kCooling:
      p.sliding.cooling *= std::exp(change);
      break;
    case Coordinate::kCarried:
      p.sliding.carried *= std::exp(change);
      break;
    case Coordinate::kWidth:
      p.sliding.width *= std::exp(change);
      break;
    case Coordinate::kForceKnot:
      p.force_knots[free.index] += change;
      break;
    case Coordinate::kVelocityKnot:
      p.velocity_knots[free.index] += change;
      break;
    case Coordinate::kDelay:
      p.delay += change;
      break;
    case Coordinate::kGain:
      p.gain *= std::exp(change);
      break;
    case Coordinate::kContact:
      p.contact += change;
      break;
    case Coordinate::kDetuning:
      p.detuning[free.index] += change;
      break;
  }
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

void free_more(const FreedOptions& options, std::span<const std::size_t> modes,
               ParameterSpace& space) {
  ObserverParameters& start = space.start();
  const auto free = [&](Coordinate coordinate, std::size_t index, double step, double prior) {
    space.free_also({coordinate, index, step, prior / step});
  };
  if (options.adherence_damping) free(Coordinate::kDamping, 0, 0.08, 2.0);
  start.force_knots.assign(options.force_knots, 0.0);
  start.velocity_knots.assign(options.velocity_knots, 0.0);
  for (std::size_t i = 0; i < options.force_knots; ++i) {
    free(Coordinate::kForceKnot, i, 0.02, 0.3);
  }
  for (std::size_t i = 0; i < options.velocity_knots; ++i) {
    free(Coordinate::kVelocityKnot, i, 0.01, 0.3);
  }
  if (options.delay) free(Coordinate::kDelay, 0, 1e-6, 1e-4);
  if (options.gain) free(Coordinate::kGain, 0, 0.01, 0.3);
  if (options.contact) free(Coordinate::kContact, 0, 3e-4 * start.contact, 0.1 * start.contact);
  if (options.frequencies) {
    start.detuning.assign(modes.empty() ? 0 : modes.back() + 1, 0.0);
    for (const std::size_t n : modes) free(Coordinate::kDetuning, n, 1e-5, 1e-3);
  }
}

}  // namespace modcal::observer
