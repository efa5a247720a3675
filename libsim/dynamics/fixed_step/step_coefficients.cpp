#include "libsim/dynamics/fixed_step/step_coefficients.hpp"

#include <numeric>

namespace modcal {
namespace {

using Complex = std::complex<double>;
using ComplexVector = std::vector<Complex>;

double total(const AlignedVector& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// P = G ((1 − r̄) x₁ + x₂).
ModeSum sum_of(double MotionSample::*quantity, const ContactModes& modes,
               const SchemeWeights& weights, const ComplexVector& gain) {
  ModeSum sum;
  sum.first = padded(modes.size(), 0.0, [&](std::size_t n) {
    return modes.motion(n, (1.0 - std::conj(weights[n].propagate)) * gain[n]).*quantity;
  });
  sum.second =
      padded(modes.size(), 0.0, [&](std::size_t n) { return modes.motion(n, gain[n]).*quantity; });
  sum.kick = total(sum.second);
  return sum;
}

}  // namespace

void StepCoefficients::hold(double stiffness, double damping) {
  const auto mixed = [stiffness, damping](const AlignedVector& y, const AlignedVector& v) {
    return padded(y.size(), 0.0, [&](std::size_t n) { return stiffness * y[n] + damping * v[n]; });
  };
  held.first = mixed(displacement.first, velocity.first);
  held.second = mixed(displacement.second, velocity.second);
  held.kick = total(held.second);
}

bool are_separable(const SchemeWeights& weights) {
  for (const auto& [r, older, newer] : weights) {
    const bool distinct = std::abs(r.imag()) >= 0.05 * std::abs(1.0 - r);
    const bool driven = std::abs(r * newer + older) >= 1e-3 * (std::abs(older) + std::abs(newer));
    if (!distinct || !driven) return false;
  }
  return true;
}

StepCoefficients make_step_coefficients(const ContactModes& modes, const SchemeWeights& weights,
                                        double initial_force) {
  const std::size_t size = modes.size();
  ComplexVector r, direct(size), deferred(size), gain(size), state(size);
  for (std::size_t n = 0; n < size; ++n) {
    const auto& [propagate, older, newer] = weights[n];
    r.push_back(propagate);
    direct[n] = modes.drive[n] * newer;
    deferred[n] = r[n] * direct[n] + modes.drive[n] * older;
    gain[n] = r[n] * deferred[n];
    // Without the drive, whose square may underflow.
    const Complex unit = r[n] * newer + older;
    state[n] = (modes.initial[n] / modes.drive[n] - newer * initial_force) / unit;
  }
  StepCoefficients c;
  c.decay = padded(size, 0.0, [&](std::size_t n) { return std::norm(r[n]); });
  // An x₁ of the padding that has no mode would otherwise take up every force.
  c.turn = padded(size, 1.0, [&](std::size_t n) { return std::norm(1.0 - r[n]); });
  c.first = padded(size, 0.0, [&](std::size_t n) { return state[n].imag() / r[n].imag(); });
  c.second = padded(
      size, 0.0, [&](std::size_t n) { return state[n].real() - (1.0 - r[n].real()) * c.first[n]; });
  c.velocity = sum_of(&MotionSample::velocity, modes, weights, gain);
  c.displacement = sum_of(&MotionSample::displacement, modes, weights, gain);
  c.left = sum_of(&MotionSample::left, modes, weights, gain);
  c.right = sum_of(&MotionSample::right, modes, weights, gain);
  c.deferred_response = motion_of(modes, deferred);
  c.direct_response = motion_of(modes, direct);
  return c;
}

}  // namespace modcal
