#include "libsim/dynamics/friction/elasto_plastic.hpp"

#include "libsim/base/error.hpp"

namespace modcal {

void ElastoPlastic::Options::visit(OptionVisitor& visitor) {
  visitor.number({.key = "static",
                  .meaning = "static friction coefficient mu_S",
                  .unit = "1",
                  .range = Range::positive()},
                 static_coefficient);
  visitor.number({.key = "dynamic",
                  .meaning = "dynamic friction coefficient mu_D at high speed, at most mu_S",
                  .unit = "1",
                  .range = Range::positive()},
                 dynamic_coefficient);
  visitor.number({.key = "stribeck_speed",
                  .meaning = "sliding speed v_s over which the coefficient falls",
                  .unit = "m/s",
                  .range = Range::positive()},
                 stribeck_speed);
  visitor.text({.key = "model",
                .meaning = "elasto_plastic: no creep below breakaway; lugre: creep at any load",
                .choices = {"elasto_plastic", "lugre"}},
               model);
  visitor.number({.key = "breakaway",
                  .meaning = "largest elastic deflection over that of dynamic friction "
                             "(elasto_plastic)",
                  .unit = "1",
                  .range = {0.0, 1.0, true, false}},
                 breakaway);
  visitor.section({.key = "bristle", .meaning = "spring and damper of the bristles"}, bristle);
}

ElastoPlastic::ElastoPlastic(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.dynamic_coefficient > 0.0 &&
                     options.dynamic_coefficient <= options.static_coefficient,
                 "dynamic friction coefficient {:g} must be > 0 and at most the static one, {:g}",
                 options.dynamic_coefficient, options.static_coefficient);
  MODCAL_REQUIRE(options.model == "elasto_plastic" || options.model == "lugre",
                 "unknown bristle model \"{}\": elasto_plastic or lugre", options.model);
}

StatefulLaw ElastoPlastic::make_stateful() const {
  return BristleFriction{.dynamic_coefficient = options_.dynamic_coefficient,
                         .drop = options_.static_coefficient - options_.dynamic_coefficient,
                         .stribeck_speed = options_.stribeck_speed,
                         .stiffness = options_.bristle.stiffness,
                         .breakaway = options_.model == "lugre" ? -1.0 : options_.breakaway};
}

}  // namespace modcal
