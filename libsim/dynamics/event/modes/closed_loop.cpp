#include "libsim/dynamics/event/modes/closed_loop.hpp"

#include "libsim/dynamics/event/modes/secular_roots.hpp"
#include "libsim/dynamics/event/modes/tuning.hpp"

namespace modcal::event {
namespace {

using Complex = std::complex<double>;

// Entries of a change of basis that is kept; 16 bytes each, there and back.
constexpr std::size_t kMostEntries = std::size_t{512} * 512;

// What one root contributes: 1/((μ − λ_n)(μ − λ̄_n)) for every mode and sums over them.
struct RootColumn {
  std::vector<Complex> inverse;
  Complex biorthogonal = 0.0;  // l·r = −2 dσ/dμ with r of unit force
  double condition = 0.0;      // |l||r|/|l·r| in the energy norm, Z/√d
};

RootColumn root_column(std::span<const OpenLoopMode> modes, double stiffness, double damping,
                       const SecularRoot& root) {
  RootColumn column;
  double left = 0.0, right = 0.0;
  for (const OpenLoopMode& mode : modes) {
    const Complex from = root.minus(mode.pole);
    const Complex mirrored = root.minus(std::conj(mode.pole));
    const Complex gain = (stiffness + damping * mode.pole) / Complex(0.0, mode.pole.imag());
    column.inverse.push_back(1.0 / (from * mirrored));
    column.biorthogonal +=
        mode.drive * (gain / (from * from) + std::conj(gain) / (mirrored * mirrored));
    const double both = 1.0 / std::norm(from) + 1.0 / std::norm(mirrored);
    left += mode.drive * std::norm(gain) * both;
    right += mode.drive * both;
  }
  column.condition = std::sqrt(left) * std::sqrt(right) / std::abs(column.biorthogonal);
  return column;
}

std::vector<OpenLoopMode> open_loop(const ContactModes& modes) {
  std::vector<OpenLoopMode> result;
  for (std::size_t n = 0; n < modes.size(); ++n) result.push_back({modes.pole[n], modes.drive[n]});
  return result;
}

// Response of Σ Re(ḡ Z) to a slow force.
template <typename GainOf>
QuasiStatic quasi_static(const ContactModes& modes, const GainOf& gain_of) {
  QuasiStatic result;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const Complex inverse = 1.0 / modes.pole[n], gain = gain_of(n);
    // Of Im Z and of Re Z.
    const Complex turned = -gain.imag() * modes.drive[n] * inverse;
    const Complex straight = -gain.real() * modes.drive[n] * inverse;
    result.value += turned.imag() + straight.real();
    result.rate += (turned * inverse).imag() + (straight * inverse).real();
    result.curvature += (turned * inverse * inverse).imag() + (straight * inverse * inverse).real();
  }
  return result;
}

void size_maps(const ContactModes& modes, ClosedLoop& loop) {
  const std::size_t n = loop.modes, m = loop.roots;
  for (PoleMap* map : {&loop.to_closed, &loop.to_open}) {
    const bool closing = map == &loop.to_closed;
    const std::size_t inputs = closing ? n : m, outputs = closing ? m : n;
    map->a = map->b = PlanarVector(inputs);
    map->p = map->q = PlanarVector(outputs);
    if (n * m <= kMostEntries) {
      map->matrix = PlanarRows(inputs, outputs);
    } else {
      map->towards_roots = closing;
      map->pole = PlanarVector(n);
      map->anchor = map->offset = PlanarVector(m);
      for (std::size_t i = 0; i < n; ++i) map->pole.set(i, modes.pole[i]);
    }
    map->scratch_a.resize(padded_size(inputs));
    map->scratch_b.resize(padded_size(inputs));
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Complex pole = modes.pole[i];
    const Complex gain = (loop.stiffness + loop.damping * pole) / Complex(0.0, pole.imag());
    loop.to_closed.a.set(i, 2.0 * gain);
    loop.to_closed.b.set(i, 2.0 * gain * std::conj(pole));
    loop.to_open.p.set(i, modes.drive[i]);
    loop.to_open.q.set(i, -modes.drive[i] * pole);
  }
}

void fill_root(const ContactModes& modes, std::span<const OpenLoopMode> open, std::size_t j,
               const SecularRoot& root, const RootColumn& column, ClosedLoop& loop) {
  const Complex mu = root.value();
  loop.pole.set(j, mu);
  loop.largest_pole = std::max(loop.largest_pole, std::abs(mu));
  loop.to_open.a.set(j, std::conj(mu));
  loop.to_open.b.set(j, 1.0);
  const Complex scale = (root.is_real() ? 1.0 : 2.0) / column.biorthogonal;
  const bool kept = loop.to_closed.matrix.count > 0;
  // A matrix that is kept holds the scale.
  loop.to_closed.p.set(j, kept ? mu : mu * scale);
  loop.to_closed.q.set(j, kept ? -1.0 : -scale);
  for (PoleMap* map : {&loop.to_closed, &loop.to_open}) {
    if (kept) continue;
    map->anchor.set(j, root.anchor());
    map->offset.set(j, root.offset());
  }
  Complex left = 0.0, right = 0.0;
  for (std::size_t n = 0; n < open.size(); ++n) {
    const Complex pole = open[n].pole;
    if (kept) {
      loop.to_closed.matrix.set(n, j, scale * column.inverse[n]);
      const Complex pair = -root.minus(pole) * (pole - std::conj(mu));
      loop.to_open.matrix.set(j, n, 1.0 / pair);
    }
    // Re(ḡ Z_n) = Re Σ_j w_j d [Re g (μ_j − Re λ) + Im g ω_d]/((μ_j − λ)(μ_j − λ̄)).
    const auto weight = [&](Complex gain) {
      return gain.imag() * (open[n].drive * pole.imag()) +
             gain.real() * open[n].drive * (mu - pole.real());
    };
    left += weight(modes.left_gain[n]) * column.inverse[n];
    right += weight(modes.right_gain[n]) * column.inverse[n];
  }
  loop.observed.set(ClosedLoop::kVelocity, j, -mu / (loop.stiffness + loop.damping * mu));
  loop.observed.set(ClosedLoop::kLeft, j, left);
  loop.observed.set(ClosedLoop::kRight, j, right);
}

void fill_particular(const ContactModes& modes, ClosedLoop& loop) {
  for (std::size_t k = 0; k < loop.open_slow.size(); ++k) {
    loop.open_slow[k] = PlanarVector(loop.modes);
    loop.closed_slow[k] = PlanarVector(loop.roots);
    for (std::size_t n = 0; n < loop.modes; ++n) {
      const Complex inverse = 1.0 / modes.pole[n];
      const Complex before = k == 0 ? -modes.drive[n] : loop.open_slow[k - 1].at(n);
      loop.open_slow[k].set(n, before * inverse);
    }
    apply(loop.to_closed, loop.modes, loop.open_slow[k], loop.closed_slow[k]);
  }
  loop.displacement =
      quasi_static(modes, [&](std::size_t n) { return Complex(0.0, modes.compliance[n]); });
  loop.left = quasi_static(modes, [&](std::size_t n) { return modes.left_gain[n]; });
  loop.right = quasi_static(modes, [&](std::size_t n) { return modes.right_gain[n]; });
}

// Whether the coordinates are complete: a state that touches every mode comes back from them. Fails
// where a root is wrong, missing or listed twice.
bool is_complete(const ContactModes& modes, ClosedLoop& loop) {
  PlanarVector state(loop.modes), coordinates(loop.roots), back(loop.modes);
  double error = 0.0;
  for (std::size_t n = 0; n < loop.modes; ++n) {
    const double phase = 1.0 + 2.4 * static_cast<double>(n);
    state.set(n, std::polar(std::sqrt(modes.drive[n]), phase));
  }
  apply(loop.to_closed, loop.modes, state, coordinates);
  apply(loop.to_open, loop.roots, coordinates, back);
  for (std::size_t n = 0; n < loop.modes; ++n) {
    error += std::norm(back.at(n) - state.at(n)) / modes.drive[n];
  }
  return error <= kWorstRoundTrip * kWorstRoundTrip * static_cast<double>(loop.modes);
}

}  // namespace

PlanarVector ClosedLoop::propagator(double time) const {
  PlanarVector result(roots);
  for (std::size_t j = 0; j < roots; ++j) result.set(j, std::exp(pole.at(j) * time));
  return result;
}

SlowForce ClosedLoop::slow_force(double bow_velocity, double bow_acceleration,
                                 double rest_point) const {
  const double inverse = 1.0 / (1.0 + stiffness * displacement.value);
  const double second = stiffness * displacement.rate + damping * displacement.value;
  const double third = stiffness * displacement.curvature + damping * displacement.rate;
  SlowForce force;
  force.curvature = inverse * stiffness * bow_acceleration;
  force.rate =
      inverse * (stiffness * bow_velocity + damping * bow_acceleration - second * force.curvature);
  force.start = inverse * (stiffness * rest_point + damping * bow_velocity - second * force.rate -
                           third * force.curvature);
  return force;
}

std::optional<ClosedLoop> make_closed_loop(const ContactModes& modes, double stiffness,
                                           double damping) {
  const std::vector<OpenLoopMode> open = open_loop(modes);
  const auto roots = secular_roots(open, stiffness, damping);
  if (!roots) return std::nullopt;
  ClosedLoop loop;
  loop.modes = modes.size();
  loop.roots = roots->size();
  loop.stiffness = stiffness;
  loop.damping = damping;
  loop.pole = PlanarVector(loop.roots);
  loop.observed = PlanarRows(ClosedLoop::kRows, loop.roots);
  size_maps(modes, loop);
  for (std::size_t j = 0; j < loop.roots; ++j) {
    const RootColumn column = root_column(open, stiffness, damping, (*roots)[j]);
    if (!(column.condition < kWorstCondition)) return std::nullopt;
    fill_root(modes, open, j, (*roots)[j], column, loop);
  }
  if (!is_complete(modes, loop)) return std::nullopt;
  fill_particular(modes, loop);
  return loop;
}

}  // namespace modcal::event
