#include "libsim/dynamics/fixed_step/scene_setup.hpp"

#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

Signal named(std::string quantity, std::string unit, double rate, bool wanted, std::size_t count) {
  return {std::move(quantity), std::move(unit), rate, std::vector<double>(wanted ? count : 0)};
}

double* target_of(Signal& signal) {
  return signal.samples.empty() ? nullptr : signal.samples.data();
}

}  // namespace

ContactModes scene_modes(const Scene& scene) {
  MODCAL_REQUIRE(scene.bow.contact_points().size() == 1,
                 "{} contact points over {:g} m: this simulator has one; use modal_exact or "
                 "newmark_explicit, or a bow of width 0",
                 scene.bow.points, scene.bow.width);
  const ModalBasis basis = make_modal_basis(scene.string);
  ContactModes modes = contact_modes(basis, scene.bow.position, initial_state(scene, basis));
  if (scene.torsion.present) {
    const ModalBasis torsional = scene.torsion.basis(basis, scene.string.wave_speed());
    modes.append(contact_modes(torsional, scene.bow.position, {}));
  }
  return modes;
}

LineModes scene_line_modes(const Scene& scene) {
  const ModalBasis transverse = make_modal_basis(scene.string);
  return line_modes(transverse, scene.torsion.basis(transverse, scene.string.wave_speed()),
                    scene.bow.contact_points(), initial_state(scene, transverse));
}

BowMotion steady_motion(const Scene& scene, std::string_view simulator) {
  BowMotion motion = bow_motion(scene.bow, scene.duration);
  MODCAL_REQUIRE(motion.is_steady(),
                 "the bow's velocity goes from {:g} to {:g} m/s and its force from {:g} to {:g} N, "
                 "but {} has a steady bow only: use steady gestures or another simulator",
                 motion.velocity.lowest(), motion.velocity.highest(), motion.normal_force.lowest(),
                 motion.normal_force.highest(), simulator);
  return motion;
}

ContactParameters contact_parameters(const BowMotion& motion, const FrictionLaw& friction,
                                     double effective_mass) {
  const Adherence adherence = friction.adherence();
  const bool near_critical = std::isnan(adherence.damping);
  return {.bow_velocity = motion.velocity.at(0.0),
          .static_limit = friction.static_limit(motion.normal_force.at(0.0)),
          .stiffness = adherence.stiffness,
          .damping = near_critical ? 2.0 * std::sqrt(adherence.stiffness * effective_mass)
                                   : adherence.damping};
}

Simulation empty_simulation(std::size_t count, double rate, const OutputRequest& outputs) {
  Simulation result;
  result.displacement = named("y", "m", rate, outputs.displacement, count);
  result.velocity = named("v", "m/s", rate, outputs.velocity, count);
  result.force = named("f_c", "N", rate, outputs.force, count);
  result.left_reaction = named("R1", "N", rate, outputs.left_reaction, count);
  result.right_reaction = named("R2", "N", rate, outputs.right_reaction, count);
  return result;
}

SampleTargets targets_of(Simulation& result) {
  return {.displacement = target_of(result.displacement),
          .velocity = target_of(result.velocity),
          .force = target_of(result.force),
          .left_reaction = target_of(result.left_reaction),
          .right_reaction = target_of(result.right_reaction)};
}

}  // namespace modcal
