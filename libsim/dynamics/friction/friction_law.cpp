#include "libsim/dynamics/friction/friction_law.hpp"

#include <array>

#include "libsim/base/words.hpp"

namespace modcal {
namespace {

void visit_falling(OptionVisitor& visitor, const Range& range, double& static_coefficient,
                   double& dynamic_coefficient) {
  visitor("static", "static friction coefficient mu_S", {.range = range}, static_coefficient);
  visitor("dynamic", "dynamic friction coefficient mu_D at high speed, at most mu_S",
          {.range = range}, dynamic_coefficient);
}

void visit_adherence(OptionVisitor& visitor, Adherence& adherence) {
  visitor("adherence", "spring and damper while sticking", adherence);
}

// μ_S − μ_D of a law that falls with the sliding speed.
template <typename Options>
double fall_of(const Options& options) {
  MODCAL_REQUIRE(options.dynamic_coefficient <= options.static_coefficient,
                 "dynamic friction coefficient {:g} is above the static one, {:g}: the law must "
                 "fall with the sliding speed",
                 options.dynamic_coefficient, options.static_coefficient);
  return options.static_coefficient - options.dynamic_coefficient;
}

enum class BristleModel { kElastoPlastic, kLuGre };
constexpr std::array<std::string_view, 2> kBristleModels = {"elasto_plastic", "lugre"};

BristleFriction bristles_of(const ElastoPlastic::Options& options) {
  MODCAL_REQUIRE(options.dynamic_coefficient > 0.0 &&
                     options.dynamic_coefficient <= options.static_coefficient,
                 "dynamic friction coefficient {:g} must be > 0 and at most the static one, {:g}",
                 options.dynamic_coefficient, options.static_coefficient);
  const auto model = enum_of<BristleModel>(kBristleModels, "bristle model", options.model);
  return {.dynamic_coefficient = options.dynamic_coefficient,
          .drop = options.static_coefficient - options.dynamic_coefficient,
          .stribeck_speed = options.stribeck_speed,
          .stiffness = options.bristle.stiffness,
          .breakaway = model == BristleModel::kLuGre ? -1.0 : options.breakaway};
}

ThermalSliding rosin_of(const Thermal::Options& options) {
  MODCAL_REQUIRE(options.hot_coefficient <= options.cold_coefficient,
                 "hot friction coefficient {:g} is above the cold one, {:g}: rosin softens",
                 options.hot_coefficient, options.cold_coefficient);
  MODCAL_REQUIRE(options.heat_capacity > 0.0 && options.softening_width > 0.0,
                 "heat capacity {:g} J/K and softening width {:g} K must be > 0",
                 options.heat_capacity, options.softening_width);
  return {.hot = options.hot_coefficient,
          .drop = options.cold_coefficient - options.hot_coefficient,
          .softening = options.softening_rise,
          .softening_width = options.softening_width,
          .capacity = options.heat_capacity,
          .conductance = options.conductance,
          .carried = options.carried_heat};
}

}  // namespace

void Adherence::visit(OptionVisitor& visitor) {
  visitor("stiffness", "adherence stiffness K_a", {.unit = "N/m", .range = Range::positive()},
          stiffness);
  visitor("damping", "adherence damping C_a; near_critical: 2 sqrt(K_a m_eff)",
          {.unit = "N s/m", .range = Range::non_negative(), .word = "near_critical"}, damping);
}

SlidingLaw FrictionLaw::sliding(double normal_force) const {
  MODCAL_REQUIRE(normal_force >= 0.0, "normal force {:g} N must be >= 0", normal_force);
  MODCAL_REQUIRE(!has_state(),
                 "this friction law has a state (temperature, deflection): it is no curve over the "
                 "sliding speed; use a law of the sliding speed alone");
  SlidingLaw law = coefficient_;
  std::visit(
      [normal_force](auto& curve) {
        curve.dynamic_force *= normal_force;
        curve.force_drop *= normal_force;
      },
      law);
  return law;
}

double FrictionLaw::static_limit(double normal_force) const {
  MODCAL_REQUIRE(normal_force >= 0.0, "normal force {:g} N must be >= 0", normal_force);
  return static_coefficient_ * normal_force;
}

void CoulombExponential::Options::visit(OptionVisitor& visitor) {
  visit_falling(visitor, Range::non_negative(), static_coefficient, dynamic_coefficient);
  visitor("decay", "decay C of the friction coefficient with the sliding speed",
          {.unit = "s/m", .range = Range::non_negative()}, decay);
  visit_adherence(visitor, adherence);
}

CoulombExponential::CoulombExponential(const Options& options)
    : FrictionLaw(options.adherence, options.static_coefficient,
                  ExponentialSliding{.dynamic_force = options.dynamic_coefficient,
                                     .force_drop = fall_of(options),
                                     .decay = options.decay}) {}

void Hyperbolic::Options::visit(OptionVisitor& visitor) {
  visit_falling(visitor, Range::non_negative(), static_coefficient, dynamic_coefficient);
  visitor("half_speed", "sliding speed v0 at which half of the fall has happened",
          {.unit = "m/s", .range = Range::positive()}, half_speed);
  visit_adherence(visitor, adherence);
}

Hyperbolic::Hyperbolic(const Options& options)
    : FrictionLaw(options.adherence, options.static_coefficient,
                  HyperbolicSliding{.dynamic_force = options.dynamic_coefficient,
                                    .force_drop = fall_of(options),
                                    .half_speed = options.half_speed}) {
  MODCAL_REQUIRE(options.half_speed > 0.0, "half speed {:g} m/s must be > 0", options.half_speed);
}

void ElastoPlastic::Options::visit(OptionVisitor& visitor) {
  visit_falling(visitor, Range::positive(), static_coefficient, dynamic_coefficient);
  visitor("stribeck_speed", "sliding speed v_s over which the coefficient falls",
          {.unit = "m/s", .range = Range::positive()}, stribeck_speed);
  visitor("model", "elasto_plastic: no creep below breakaway; lugre: creep at any load",
          {.choices = choices_of(kBristleModels)}, model);
  visitor("breakaway",
          "largest elastic deflection over that of dynamic friction "
          "(elasto_plastic)",
          {.range = {0.0, 1.0, true, false}}, breakaway);
  visitor("bristle", "spring and damper of the bristles", bristle);
}

ElastoPlastic::ElastoPlastic(const Options& options)
    : FrictionLaw(options.bristle, options.static_coefficient, {}, bristles_of(options)) {}

void Thermal::Options::visit(OptionVisitor& visitor) {
  visitor("cold", "friction coefficient far below softening", {.range = Range::non_negative()},
          cold_coefficient);
  visitor("hot", "friction coefficient far above softening, at most cold",
          {.range = Range::non_negative()}, hot_coefficient);
  visitor("softening_rise", "temperature rise at which half of the fall has happened",
          {.unit = "K", .range = Range::positive()}, softening_rise);
  visitor("softening_width", "width of the fall", {.unit = "K", .range = Range::positive()},
          softening_width);
  visitor("heat_capacity", "heat capacity H of the contact",
          {.unit = "J/K", .range = Range::positive()}, heat_capacity);
  visitor("conductance", "conduction G of heat into string and bow",
          {.unit = "W/K", .range = Range::non_negative()}, conductance);
  visitor("carried_heat", "heat S that leaves with the material, per length rubbed past",
          {.unit = "J/K/m", .range = Range::non_negative()}, carried_heat);
  visit_adherence(visitor, adherence);
}

Thermal::Thermal(const Options& options)
    : FrictionLaw(options.adherence, rosin_of(options).at(0.0).force, {}, rosin_of(options)) {}

Registry<FrictionLaw> FrictionLaw::registry() {
  static constexpr std::array kTable = {
      entry_of<FrictionLaw, CoulombExponential>(
          "coulomb_exponential", "Coulomb friction falling exponentially with the sliding speed"),
      entry_of<FrictionLaw, ElastoPlastic>(
          "elasto_plastic", "bristles that deflect before they slide, LuGre as a case"),
      entry_of<FrictionLaw, Hyperbolic>(
          "hyperbolic", "Coulomb friction falling as a hyperbola of the sliding speed"),
      entry_of<FrictionLaw, Thermal>("thermal",
                                     "rosin that softens with the temperature of the contact"),
  };
  return kTable;
}

}  // namespace modcal
