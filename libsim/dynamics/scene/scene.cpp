#include "libsim/dynamics/scene/scene.hpp"

#include <array>

namespace modcal {

namespace {

double normalized_sinc(double u) {
  const double angle = std::numbers::pi * u;
  return u == 0.0 ? 1.0 : std::sin(angle) / angle;
}

}  // namespace

void Pluck::Options::visit(OptionVisitor& visitor) {
  visitor("position", "plucking point, from the end x = 0",
          {.unit = "m", .range = Range::positive(), .required = true}, position);
  visitor("displacement", "height of the triangle", {.unit = "m", .required = true}, displacement);
  visitor("width", "width over which its corner is rounded",
          {.unit = "m", .range = Range::non_negative()}, width);
}

ModalState Pluck::state(const ModalBasis& basis) const {
  const double length = basis.length, x = options_.position;
  MODCAL_REQUIRE(x > 0.0 && x < length,
                 "plucking point {:g} m is not inside the string: it must lie in (0, {:g}) m", x,
                 length);
  MODCAL_REQUIRE(std::isfinite(options_.displacement), "the pluck's displacement must be finite");
  const double room = 2.0 * std::min(x, length - x);
  MODCAL_REQUIRE(options_.width >= 0.0 && options_.width <= room,
                 "a pluck {:g} m wide at {:g} m reaches past the end of the string: at most {:g} m",
                 options_.width, x, room);
  const double scale = 2.0 * options_.displacement * length * length /
                       (std::numbers::pi * std::numbers::pi * x * (length - x));
  const std::vector<double> shape = basis.shape_at(x);
  ModalState state;
  state.velocity.assign(basis.size(), 0.0);
  for (std::size_t i = 0; i < basis.size(); ++i) {
    const double n = static_cast<double>(i + 1);
    state.displacement.push_back(scale * shape[i] *
                                 normalized_sinc(0.5 * n * options_.width / length) / (n * n));
  }
  return state;
}

Registry<InitialMotion> InitialMotion::registry() {
  static constexpr std::array kTable = {
      entry_of<InitialMotion, Pluck>("pluck", "released from a triangle"),
      entry_of<InitialMotion, Rest>("rest", "straight and at rest"),
  };
  return kTable;
}

void Torsion::visit(OptionVisitor& visitor) {
  visitor("modes", "number of torsional modes", {.range = Range::closed(1, 5000)}, modes);
  visitor("speed_ratio", "torsional over transverse wave speed", {.range = Range::positive()},
          speed_ratio);
  visitor("impedance_ratio", "torsional over transverse wave impedance at the surface",
          {.range = Range::positive()}, impedance_ratio);
  visitor("damping_ratio", "damping ratio of the torsional modes",
          {.range = {0.0, 1.0, true, false}}, damping_ratio);
}

ModalBasis Torsion::basis(const ModalBasis& transverse, double wave_speed) const {
  ModalBasis result;
  result.length = transverse.length;
  if (!present) return result;
  MODCAL_REQUIRE(speed_ratio > 0.0 && impedance_ratio > 0.0,
                 "torsional speed ratio {:g} and impedance ratio {:g} must be > 0", speed_ratio,
                 impedance_ratio);
  MODCAL_REQUIRE(damping_ratio >= 0.0 && damping_ratio < 1.0,
                 "torsional damping ratio {:g} must be in [0, 1)", damping_ratio);
  MODCAL_REQUIRE(modes >= 1, "{} torsional modes: at least one is needed", modes);
  // m_T = μ_T L/2 with μ_T = (Z_T/Z₀) ρ_L c/c_T, and ρ_L L/2 is the transverse modal mass.
  const double mass = transverse.mass.at(0) * impedance_ratio / speed_ratio;
  for (std::int64_t n = 1; n <= modes; ++n) {
    result.omega.push_back(static_cast<double>(n) * std::numbers::pi * speed_ratio * wave_speed /
                           transverse.length);
    result.zeta.push_back(damping_ratio);
    result.mass.push_back(mass);
  }
  return result;
}

void Scene::visit(OptionVisitor& visitor) {
  visitor("string", "the string", string);
  visitor("bow", "the bow stroke", bow);
  visitor("friction", "friction between bow and string", friction);
  visitor("duration", "length of the record", {.unit = "s", .range = Range::positive()}, duration);
  visitor("initial", "motion of the string at t = 0", start);
  visitor("torsion", "torsional modes of the string", torsion.present, torsion);
}

ModalState initial_state(const Scene& scene, const ModalBasis& basis) {
  if (!scene.initial.displacement.empty() || !scene.initial.velocity.empty()) return scene.initial;
  return scene.start.make()->state(basis);
}

}  // namespace modcal
