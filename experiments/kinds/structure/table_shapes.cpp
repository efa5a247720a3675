#include "experiments/kinds/structure/table_shapes.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/records/universal/universal_modes.hpp"

namespace modcal {
namespace {

// "12 +3", "12:-3", "12 z".
UniversalPlace place_of(std::string_view text) {
  UniversalPlace place;
  const char* const end = text.data() + text.size();
  const char* at = std::from_chars(text.data(), end, place.node).ptr;
  while (at < end && (*at == ' ' || *at == ':')) ++at;
  const int sign = at < end && *at == '-' ? -1 : 1;
  if (at < end && (*at == '-' || *at == '+')) ++at;
  constexpr std::string_view kAxes = "123xyzXYZ";
  const std::size_t axis = end - at == 1 ? kAxes.find(*at) : std::string_view::npos;
  MODCAL_REQUIRE(place.node > 0 && axis != std::string_view::npos,
                 "\"{}\" is no node with a direction: write \"12 +3\" or \"12 -z\"", text);
  place.direction = sign * (static_cast<int>(axis % 3) + 1);
  return place;
}

}  // namespace

void ShapesOptions::visit(OptionVisitor& visitor) {
  visitor("file", "universal file with datasets 55, relative to the table's folder",
          {.required = true}, file);
  visitor("contact",
          "node and direction of the force, as \"12 +3\" or \"12 -z\" (x, y, z are 1, 2, 3)",
          {.required = true}, contact);
  visitor("sensors", "those of the sensors, in their order", {.required = true}, sensors);
  visitor("damping_ratio", "of modes for which the file states none",
          {.range = Range::open(0.0, 1.0), .word = "none"}, damping_ratio);
}

void take_shapes(const ShapesOptions& options, const std::filesystem::path& file,
                 StructureTable& table) {
  ModalModel& model = table.model;
  MODCAL_REQUIRE(options.sensors.size() == model.sensors.size(),
                 "{}: shapes.sensors has {} places for {} sensors", file.string(),
                 options.sensors.size(), model.sensors.size());
  const std::filesystem::path path = file.parent_path() / options.file;
  UniversalModes read = read_universal_modes(path);
  std::ranges::sort(read.modes, {}, [](const UniversalMode& mode) { return mode.pole.omega; });
  const UniversalPlace contact = place_of(options.contact);
  for (UniversalMode& mode : read.modes) {
    if (mode.pole.zeta == 0.0) mode.pole.zeta = options.damping_ratio;
    MODCAL_REQUIRE(mode.pole.zeta > 0.0,
                   "{}:{}: the mode states no damping: state shapes.damping_ratio in {}",
                   path.string(), mode.line, file.string());
    model.poles.push_back(mode.pole);
  }
  const auto constant_of = [&](const UniversalMode& mode, const UniversalPlace& sensor,
                               SensorKind kind) {
    try {
      return read.per_newton * mode.constant(contact, sensor, kind);
    } catch (const InvalidInput& error) {
      throw_invalid_input("{}: {}", path.string(), error.what());
    }
  };
  for (std::size_t k = 0; k < model.sensors.size(); ++k) {
    const UniversalPlace sensor = place_of(options.sensors[k]);
    for (const UniversalMode& mode : read.modes) {
      const Complex constant = constant_of(mode, sensor, model.sensors[k]);
      model.constants.push_back(constant.real());
      model.quadrature.push_back(constant.imag());
    }
  }
  for (const UniversalMode& mode : read.modes) {
    const Complex constant = constant_of(mode, contact, SensorKind::kDisplacement);
    // A shape that was not measured there stands for no motion, such as the 1 that fit_modes
    // writes.
    if (!(std::abs(constant.imag()) <= constant.real())) {
      table.contact.clear();
      break;
    }
    table.contact.push_back(constant.real());
  }
  table.frequency_deviations.assign(model.poles.size(), 0.0);
  table.damping_deviations.assign(model.poles.size(), 0.0);
}

}  // namespace modcal
