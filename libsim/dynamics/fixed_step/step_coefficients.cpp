#include "libsim/dynamics/fixed_step/step_coefficients.hpp"

#include <cmath>
#include <numeric>

namespace modcal {
namespace {

using Complex = std::complex<double>;
using ComplexVector = std::vector<Complex>;

// What a state Z of mode n is of velocity, displacement and reactions.
using Quantity = double (*)(const ContactModes&, std::size_t, Complex);
constexpr Quantity kVelocity = [](const ContactModes& modes, std::size_t n, Complex z) {
  return z.real() - modes.quadrature[n] * z.imag();
};
constexpr Quantity kDisplacement = [](const ContactModes& modes, std::size_t n, Complex z) {
  return modes.compliance[n] * z.imag();
};
constexpr Quantity kLeft = [](const ContactModes& modes, std::size_t n, Complex z) {
  return modes.left_gain[n] * z.imag();
};
constexpr Quantity kRight = [](const ContactModes& modes, std::size_t n, Complex z) {
  return modes.right_gain[n] * z.imag();
};

double total(const AlignedVector& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// P = G ((1 − r̄) x₁ + x₂).
ModeSum sum_of(Quantity quantity, const ContactModes& modes, const ComplexVector& propagate,
               const ComplexVector& gain) {
  ModeSum sum;
  sum.first = padded(modes.size(), 0.0, [&](std::size_t n) {
    return quantity(modes, n, (1.0 - std::conj(propagate[n])) * gain[n]);
  });
  sum.second =
      padded(modes.size(), 0.0, [&](std::size_t n) { return quantity(modes, n, gain[n]); });
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
  for (std::size_t n = 0; n < weights.propagate.size(); ++n) {
    const Complex r = weights.propagate[n], older = weights.older[n], newer = weights.newer[n];
    const bool distinct = std::abs(r.imag()) >= 0.05 * std::abs(1.0 - r);
    const bool driven = std::abs(r * newer + older) >= 1e-3 * (std::abs(older) + std::abs(newer));
    if (!distinct || !driven) return false;
  }
  return true;
}

StepCoefficients make_step_coefficients(const ContactModes& modes, const SchemeWeights& weights,
                                        double initial_force) {
  const std::size_t size = modes.size();
  const ComplexVector& r = weights.propagate;
  ComplexVector direct(size), deferred(size), gain(size), state(size);
  for (std::size_t n = 0; n < size; ++n) {
    direct[n] = modes.drive[n] * weights.newer[n];
    deferred[n] = r[n] * direct[n] + modes.drive[n] * weights.older[n];
    gain[n] = r[n] * deferred[n];
    // Without the drive, whose square may underflow.
    const Complex unit = r[n] * weights.newer[n] + weights.older[n];
    state[n] = (modes.initial[n] / modes.drive[n] - weights.newer[n] * initial_force) / unit;
  }
  StepCoefficients c;
  c.decay = padded(size, 0.0, [&](std::size_t n) { return std::norm(r[n]); });
  // An x₁ of the padding that has no mode would otherwise take up every force.
  c.turn = padded(size, 1.0, [&](std::size_t n) { return std::norm(1.0 - r[n]); });
  c.first = padded(size, 0.0, [&](std::size_t n) { return state[n].imag() / r[n].imag(); });
  c.second = padded(
      size, 0.0, [&](std::size_t n) { return state[n].real() - (1.0 - r[n].real()) * c.first[n]; });
  c.velocity = sum_of(kVelocity, modes, r, gain);
  c.displacement = sum_of(kDisplacement, modes, r, gain);
  c.left = sum_of(kLeft, modes, r, gain);
  c.right = sum_of(kRight, modes, r, gain);
  c.deferred_response = motion_of(modes, deferred);
  c.direct_response = motion_of(modes, direct);
  return c;
}

}  // namespace modcal
