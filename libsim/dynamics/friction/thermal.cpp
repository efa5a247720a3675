#include "libsim/dynamics/friction/thermal.hpp"

#include "libsim/base/error.hpp"

namespace modcal {

void Thermal::Options::visit(OptionVisitor& visitor) {
  visitor.number({.key = "cold",
                  .meaning = "friction coefficient far below softening",
                  .unit = "1",
                  .range = Range::non_negative()},
                 cold_coefficient);
  visitor.number({.key = "hot",
                  .meaning = "friction coefficient far above softening, at most cold",
                  .unit = "1",
                  .range = Range::non_negative()},
                 hot_coefficient);
  visitor.number({.key = "softening_rise",
                  .meaning = "temperature rise at which half of the fall has happened",
                  .unit = "K",
                  .range = Range::positive()},
                 softening_rise);
  visitor.number({.key = "softening_width",
                  .meaning = "width of the fall",
                  .unit = "K",
                  .range = Range::positive()},
                 softening_width);
  visitor.number({.key = "heat_capacity",
                  .meaning = "heat capacity H of the contact",
                  .unit = "J/K",
                  .range = Range::positive()},
                 heat_capacity);
  visitor.number({.key = "conductance",
                  .meaning = "conduction G of heat into string and bow",
                  .unit = "W/K",
                  .range = Range::non_negative()},
                 conductance);
  visitor.number({.key = "carried_heat",
                  .meaning = "heat S that leaves with the material, per length rubbed past",
                  .unit = "J/K/m",
                  .range = Range::non_negative()},
                 carried_heat);
  visitor.section({.key = "adherence", .meaning = "spring and damper while sticking"}, adherence);
}

Thermal::Thermal(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.hot_coefficient <= options.cold_coefficient,
                 "hot friction coefficient {:g} is above the cold one, {:g}: rosin softens",
                 options.hot_coefficient, options.cold_coefficient);
  MODCAL_REQUIRE(options.heat_capacity > 0.0 && options.softening_width > 0.0,
                 "heat capacity {:g} J/K and softening width {:g} K must be > 0",
                 options.heat_capacity, options.softening_width);
}

StatefulLaw Thermal::make_stateful() const {
  return ThermalSliding{.hot = options_.hot_coefficient,
                        .drop = options_.cold_coefficient - options_.hot_coefficient,
                        .softening = options_.softening_rise,
                        .softening_width = options_.softening_width,
                        .capacity = options_.heat_capacity,
                        .conductance = options_.conductance,
                        .carried = options_.carried_heat};
}

double Thermal::static_coefficient() const {
  return std::get<ThermalSliding>(make_stateful()).at(0.0).force;
}

}  // namespace modcal
