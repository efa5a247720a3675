#include "libsim/dynamics/fixed_step/first_order_hold.hpp"

#include <cmath>

namespace modcal {
namespace {

struct HoldFunctions {
  std::complex<double> first;   // φ₁(x) = (eˣ − 1)/x
  std::complex<double> second;  // φ₂(x) = (eˣ − 1 − x)/x²
};

HoldFunctions hold_functions(std::complex<double> x) {
  if (std::abs(x) > 1.0) {
    const std::complex<double> first = (std::exp(x) - 1.0) / x;
    return {first, (first - 1.0) / x};
  }
  // φ₂ = Σ x^j/(j + 2)!; 20 terms leave 1/22! ≈ 1e-21 at |x| = 1, where the closed form would
  // cancel like eps/|x|².
  std::complex<double> term = 0.5;
  std::complex<double> second = term;
  for (int j = 1; j <= 20; ++j) {
    term *= x / static_cast<double>(j + 2);
    second += term;
  }
  return {1.0 + x * second, second};
}

}  // namespace

ModeWeights first_order_hold_weights(std::complex<double> pole, double time_step) {
  const std::complex<double> x = pole * time_step;
  const HoldFunctions hold = hold_functions(x);
  return {.propagate = std::exp(x),
          .older = time_step * (hold.first - hold.second),
          .newer = time_step * hold.second};
}

}  // namespace modcal
