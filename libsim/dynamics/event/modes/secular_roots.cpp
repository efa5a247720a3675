#include "libsim/dynamics/event/modes/secular_roots.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/dynamics/event/modes/tuning.hpp"

namespace modcal::event {
namespace {

using Complex = std::complex<double>;

// The iteration is cubic: a step below 1e-7 of the offset leaves an error below rounding.
constexpr double kFrozenStep = 1e-7, kFrozenNewton = 1e-5;

struct Contact {
  double stiffness, damping;
};

// What Newton's method on the numerator P = Π (s − λ)(s − λ̄) · σ, σ = 1 + (K + C s) G(s), needs
// at a root: P/P' = σ/(σ' + σ Σ 1/(s − pole)).
struct SecularPoint {
  Complex value, slope, pole_sum;
};

SecularPoint evaluate(std::span<const OpenLoopMode> modes, Contact contact,
                      const SecularRoot& root) {
  Complex receptance = 0.0, slope = 0.0, poles = 0.0;
  for (const OpenLoopMode& mode : modes) {
    const Complex from = root.minus(mode.pole);
    const Complex mirrored = root.minus(std::conj(mode.pole));
    const Complex inverse = 1.0 / (from * mirrored);
    const Complex sum = (from + mirrored) * inverse;
    receptance += mode.drive * inverse;
    slope -= mode.drive * inverse * sum;
    poles += sum;
  }
  const Complex gain = contact.stiffness + contact.damping * root.value();
  return {1.0 + gain * receptance, contact.damping * receptance + gain * slope, poles};
}

// Aberth's step of root i: Newton's with the other roots divided out, no longer than |μ|. It is
// also short where another iterate is near by, so that Newton's own length tells convergence.
struct Step {
  Complex change;
  double newton;
};

Step aberth_step(const SecularPoint& point, bool mirrored, std::span<const SecularRoot> roots,
                 std::size_t i) {
  if (point.value == 0.0) return {0.0, 0.0};
  Complex others = 0.0;
  for (std::size_t j = 0; j < roots.size(); ++j) {
    if (j != i) others += 1.0 / roots[i].minus(roots[j]);
    if (mirrored) others += 1.0 / roots[i].minus(roots[j].conjugate());
  }
  const Complex slope = point.slope + point.value * point.pole_sum;
  Complex change = -point.value / (slope - point.value * others);
  const double size = std::abs(change), limit = std::abs(roots[i].value());
  if (size > limit) change *= limit / size;
  return {change, std::abs(point.value / slope)};
}

// First-order root beside pole n: −(K + Cλ) d/(2iω_d) over the rest of the function there.
SecularRoot first_guess(std::span<const OpenLoopMode> modes, Contact contact, std::size_t n) {
  const Complex pole = modes[n].pole;
  const Complex gain = contact.stiffness + contact.damping * pole;
  Complex rest = 1.0;
  double square = std::norm(pole);
  for (std::size_t m = 0; m < modes.size(); ++m) {
    if (m == n) continue;
    const Complex from = pole - modes[m].pole;
    rest += gain * modes[m].drive / (from * (pole - std::conj(modes[m].pole)));
    square = std::min(square, std::norm(from));
  }
  Complex offset = -gain * modes[n].drive / (Complex(0.0, 2.0 * pole.imag()) * rest);
  const double size = std::abs(offset), spacing = std::sqrt(square);
  if (size > 0.5 * spacing) offset *= 0.5 * spacing / size;
  return {pole, offset};
}

// The contact's own resonance, a root of m s² + C s + K = 0, m = 1/Σ d: where it lies far above the
// string's modes, no pole is near it.
Complex contact_resonance(std::span<const OpenLoopMode> modes, Contact contact) {
  double inverse_mass = 0.0;
  for (const OpenLoopMode& mode : modes) inverse_mass += mode.drive;
  const double half = 0.5 * contact.damping * inverse_mass;
  return -half + std::sqrt(Complex(half * half - contact.stiffness * inverse_mass, 0.0));
}

// A guess for every root with Im μ > 0: beside its pole each, but the last one at the contact's
// resonance where that is higher. A little off every line of symmetry, on which iterates would
// have to pass through each other.
std::vector<SecularRoot> first_guesses(std::span<const OpenLoopMode> modes, Contact contact) {
  std::vector<SecularRoot> guesses;
  std::size_t highest = 0;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    guesses.push_back(first_guess(modes, contact, n));
    guesses.back().move(guesses.back().offset() * Complex(0.0, 0.03));
    if (std::abs(modes[n].pole) > std::abs(modes[highest].pole)) highest = n;
  }
  const Complex resonance = contact_resonance(modes, contact);
  const Complex top = modes[highest].pole;
  if (resonance.imag() > 0.0 && std::abs(resonance) > 1.1 * std::abs(top)) {
    guesses[highest] = SecularRoot(top, (resonance - top) * Complex(1.0, 0.01));
  }
  return guesses;
}

// One run of the iteration; `mirrored` keeps a conjugate beside every root.
bool iterate(std::span<const OpenLoopMode> modes, Contact contact, bool mirrored,
             std::vector<SecularRoot>& roots) {
  std::vector<bool> frozen(roots.size(), false);
  for (int sweep = 0; sweep < kRootSweeps; ++sweep) {
    bool all_frozen = true;
    for (std::size_t i = 0; i < roots.size(); ++i) {
      if (frozen[i]) continue;
      const Step step = aberth_step(evaluate(modes, contact, roots[i]), mirrored, roots, i);
      if (!std::isfinite(step.change.real()) || !std::isfinite(step.change.imag())) return false;
      roots[i].move(step.change);
      if (mirrored && roots[i].value().imag() <= 0.0) return false;
      const double offset = std::abs(roots[i].offset());
      frozen[i] =
          std::abs(step.change) <= kFrozenStep * offset && step.newton <= kFrozenNewton * offset;
      all_frozen = all_frozen && frozen[i];
    }
    if (all_frozen) return true;
  }
  return false;
}

// The offset counted from the nearest pole: a root that wandered keeps its digits there too.
SecularRoot anchored(std::span<const OpenLoopMode> modes, const SecularRoot& root) {
  SecularRoot best = root;
  for (const OpenLoopMode& mode : modes) {
    for (const Complex pole : {mode.pole, std::conj(mode.pole)}) {
      const Complex offset = root.minus(pole);
      if (std::norm(offset) < std::norm(best.offset())) best = SecularRoot(pole, offset);
    }
  }
  return best;
}

std::optional<std::vector<SecularRoot>> upper_half(const std::vector<SecularRoot>& all) {
  std::vector<SecularRoot> kept;
  std::size_t counted = 0;
  for (const SecularRoot& root : all) {
    const Complex value = root.value();
    if (std::abs(value.imag()) <= kRealRoot * std::abs(value)) {
      kept.push_back(root.as_real());
      counted += 1;
    } else if (value.imag() > 0.0) {
      kept.push_back(root);
      counted += 2;
    }
  }
  if (counted != all.size()) return std::nullopt;
  return kept;
}

// Σ μ over all 2N roots is the trace Σ 2 Re λ − C Σ d.
bool has_the_trace(std::span<const OpenLoopMode> modes, Contact contact,
                   std::span<const SecularRoot> roots) {
  double expected = 0.0, sum = 0.0, size = 0.0;
  for (const OpenLoopMode& mode : modes) {
    expected += 2.0 * mode.pole.real() - contact.damping * mode.drive;
    size += 2.0 * std::abs(mode.pole);
  }
  for (const SecularRoot& root : roots) {
    const Complex value = root.value();
    sum += (root.is_real() ? 1.0 : 2.0) * value.real();
    size += std::abs(value);
  }
  return std::abs(sum - expected) <= 1e-10 * size;
}

}  // namespace

SecularRoot SecularRoot::as_real() const {
  SecularRoot root(anchor_, {offset_.real(), -anchor_.imag()});
  root.real_ = true;
  return root;
}

std::optional<std::vector<SecularRoot>> secular_roots(std::span<const OpenLoopMode> modes,
                                                      double stiffness, double damping) {
  const Contact contact{stiffness, damping};
  const std::vector<SecularRoot> guesses = first_guesses(modes, contact);

  // Pairs first: a quarter of the work. Pairs cannot turn into two different real roots, so
  // whatever fails there is repeated with every root on its own, from starts without symmetry.
  std::vector<SecularRoot> roots = guesses;
  if (!iterate(modes, contact, true, roots) || !has_the_trace(modes, contact, roots)) {
    roots = guesses;
    for (SecularRoot guess : guesses) {
      guess.move(0.1 * guess.offset() + Complex(-1e-3, 2e-3) * std::abs(guess.value()));
      roots.push_back(guess.conjugate());
    }
    if (!iterate(modes, contact, false, roots)) return std::nullopt;
    const auto upper = upper_half(roots);
    if (!upper || !has_the_trace(modes, contact, *upper)) return std::nullopt;
    roots = *upper;
  }
  for (SecularRoot& root : roots) {
    if (!root.is_real()) root = anchored(modes, root);
  }
  return roots;
}

}  // namespace modcal::event
