#include "libsim/dynamics/scene.hpp"

namespace modcal {

void Bow::visit(OptionVisitor& visitor) {
  visitor.number({.key = "position",
                  .meaning = "contact point x_c, from the end x = 0",
                  .unit = "m",
                  .range = Range::positive(),
                  .required = true},
                 position);
  visitor.number(
      {.key = "velocity", .meaning = "bow velocity", .unit = "m/s", .range = Range::any()},
      velocity);
  visitor.number({.key = "normal_force",
                  .meaning = "force that presses the bow on the string",
                  .unit = "N",
                  .range = Range::non_negative()},
                 normal_force);
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
}

}  // namespace modcal
