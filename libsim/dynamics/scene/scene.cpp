#include "libsim/dynamics/scene/scene.hpp"

namespace modcal {

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
