#include "libcalib/parameters/held_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/likelihood/string_unknowns.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// What is fixed by another option has one place to say so.
void require_fixable(const std::string& parameter, UnknownKind kind) {
  MODCAL_REQUIRE(kind != UnknownKind::kDampingFactor,
                 "{} cannot be fixed by itself: state damping: fixed, or each "
                 "and the ratios that "
                 "are fixed",
                 parameter);
  MODCAL_REQUIRE(kind != UnknownKind::kDampingPower,
                 "{} cannot be fixed by itself: state damping: factor", parameter);
  MODCAL_REQUIRE(
      kind != UnknownKind::kGain && kind != UnknownKind::kDelay && kind != UnknownKind::kCorner,
      "{} is fixed where it is stated: {}: {{free: false, value: ...}}", parameter, parameter);
}

double initial_or(double value, double initial) { return std::isnan(value) ? initial : value; }

}  // namespace

void FixedParameter::visit(OptionVisitor& visitor) {
  visitor.text({.key = "parameter",
                .meaning = "f0, B, x_c, f_3 or zeta_3; of a further record: x_c 2",
                .required = true},
               parameter);
  // The unit is that of the parameter, which stands before it.
  visitor.number({.key = "value",
                  .meaning = "the value it is held at, in the unit of the parameter",
                  .unit = unit_of_unknown(parameter),
                  .word = "initial"},
                 value);
}

void require_fixed(const UnknownsOptions& options, std::size_t modes, std::size_t records) {
  std::vector<UnknownName> names;
  std::size_t frequencies = 0;
  for (const FixedParameter& fixed : options.fixed) {
    const UnknownName name = require_unknown(fixed.parameter, modes);
    require_fixable(fixed.parameter, name.kind);
    MODCAL_REQUIRE(name.record < records, "\"{}\" is fixed: there {} {} record{}", fixed.parameter,
                   records == 1 ? "is" : "are", records, records == 1 ? "" : "s");
    MODCAL_REQUIRE(name.record == 0 || options.own(name.kind),
                   "\"{}\" is fixed: all records share it, state it without a number",
                   fixed.parameter);
    MODCAL_REQUIRE(std::find(names.begin(), names.end(), name) == names.end(),
                   "\"{}\" is fixed twice: state it once", fixed.parameter);
    MODCAL_REQUIRE(
        std::isnan(fixed.value) || name.kind == UnknownKind::kInharmonicity || fixed.value > 0.0,
        "{} is fixed at {:g}: it must be > 0", fixed.parameter, fixed.value);
    MODCAL_REQUIRE(!(name.kind == UnknownKind::kDampingRatio && fixed.value >= 1.0),
                   "{} is fixed at {:g}: a mode rings below 1", fixed.parameter, fixed.value);
    frequencies += name.kind == UnknownKind::kFrequency ? 1 : 0;
    names.push_back(name);
  }
  const bool law = std::find(names.begin(), names.end(), UnknownName{}) != names.end() &&
                   std::find(names.begin(), names.end(),
                             UnknownName{.kind = UnknownKind::kInharmonicity}) != names.end();
  MODCAL_REQUIRE(law || frequencies + 2 <= modes || frequencies == 0,
                 "{} of {} frequencies are fixed: the law has no two modes "
                 "left to be found by; fix "
                 "f0 and B too, or free some",
                 frequencies, modes);
}

HeldParameters HeldParameters::of_record(std::size_t record) const {
  HeldParameters result = *this;
  result.contacts.assign(1, contact(record) ? contacts[record] : std::nullopt);
  return result;
}

HeldParameters held_parameters(const UnknownsOptions& options, std::size_t modes,
                               std::size_t records, double initial_contact,
                               double initial_fundamental, double initial_inharmonicity) {
  HeldParameters held{.contacts = std::vector<std::optional<double>>(records),
                      .frequencies = std::vector<bool>(modes, false),
                      .ratios = std::vector<bool>(modes, false)};
  for (const FixedParameter& fixed : options.fixed) {
    const UnknownName name = require_unknown(fixed.parameter, modes);
    if (name.kind == UnknownKind::kFundamental) {
      held.fundamental = initial_or(fixed.value, initial_fundamental);
    }
    if (name.kind == UnknownKind::kInharmonicity) {
      held.inharmonicity = initial_or(fixed.value, initial_inharmonicity);
    }
    if (name.kind == UnknownKind::kContact) {
      held.contacts[name.record] = initial_or(fixed.value, initial_contact);
      if (!options.own(name.kind)) held.contacts.assign(records, held.contacts[name.record]);
    }
    if (name.kind == UnknownKind::kFrequency) held.frequencies[name.mode] = true;
    if (name.kind == UnknownKind::kDampingRatio) held.ratios[name.mode] = true;
  }
  return held;
}

ModelPoint with_fixed(ModelPoint initial, const UnknownsOptions& options) {
  for (const FixedParameter& fixed : options.fixed) {
    const UnknownName name = require_unknown(fixed.parameter, initial.basis.size());
    if (std::isnan(fixed.value)) continue;
    if (name.kind == UnknownKind::kFrequency) {
      initial.basis.omega[name.mode] = 2.0 * std::numbers::pi * fixed.value;
    }
    if (name.kind == UnknownKind::kDampingRatio) initial.basis.zeta[name.mode] = fixed.value;
    if (name.kind == UnknownKind::kContact && name.record == 0) initial.contact = fixed.value;
  }
  return initial;
}

}  // namespace modcal
