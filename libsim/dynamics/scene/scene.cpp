#include "libsim/dynamics/scene/scene.hpp"

#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal {

void Torsion::visit(OptionVisitor& visitor) {
  visitor.integer(
      {.key = "modes", .meaning = "number of torsional modes", .range = Range::closed(1, 5000)},
      modes);
  visitor.number({.key = "speed_ratio",
                  .meaning = "torsional over transverse wave speed",
                  .unit = "1",
                  .range = Range::positive()},
                 speed_ratio);
  visitor.number({.key = "impedance_ratio",
                  .meaning = "torsional over transverse wave impedance at the surface",
                  .unit = "1",
                  .range = Range::positive()},
                 impedance_ratio);
  visitor.number({.key = "damping_ratio",
                  .meaning = "damping ratio of the torsional modes",
                  .unit = "1",
                  .range = {0.0, 1.0, true, false}},
                 damping_ratio);
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
  visitor.section({.key = "string", .meaning = "the string"}, string);
  visitor.section({.key = "bow", .meaning = "the bow stroke"}, bow);
  visitor.plugin({.key = "friction", .meaning = "friction between bow and string"}, friction);
  visitor.number({.key = "duration",
                  .meaning = "length of the record",
                  .unit = "s",
                  .range = Range::positive()},
                 duration);
  visitor.plugin({.key = "initial", .meaning = "motion of the string at t = 0"}, start);
  visitor.optional_group({.key = "torsion", .meaning = "torsional modes of the string"},
                         torsion.present,
                         [this](OptionVisitor& members) { torsion.visit(members); });
}

ModalState initial_state(const Scene& scene, const ModalBasis& basis) {
  if (!scene.initial.displacement.empty() || !scene.initial.velocity.empty()) return scene.initial;
  return scene.start.make()->state(basis);
}

}  // namespace modcal
