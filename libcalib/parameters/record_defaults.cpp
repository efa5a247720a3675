// What is free of a record's sensors and damping where nothing is stated.
#include <algorithm>
#include <cmath>

#include "libcalib/parameters/damping_choice.hpp"
#include "libcalib/parameters/parameter_options.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

void ResponseOptions::visit(OptionVisitor& visitor) {
  visitor("response_width",
          "standard deviation of the prior of the response, of its logarithm's "
          "real and imaginary part at a knot",
          {.range = Range::positive()}, width);
  visitor("response_spacing", "between the knots of the response",
          {.unit = "Hz", .range = Range::positive(), .word = "automatic"}, spacing);
}

ResponseOptions ResponseOptions::laid_out(const ModalBasis& basis) const {
  constexpr double kWidest = 300.0, kMost = 400.0;  // Hz; knots
  const double top = basis.frequency(basis.size() - 1);
  ResponseOptions result = *this;
  if (std::isnan(spacing)) {
    result.spacing = std::max(std::min(kWidest, basis.frequency(0)), 0.01 * top);
  }
  const double knots_needed = std::ceil(1.02 * top / result.spacing) + 1.0;
  MODCAL_REQUIRE(knots_needed <= kMost,
                 "response_spacing {:g} Hz makes {:g} knots up to f_{}: state {:.3g} Hz or more",
                 result.spacing, knots_needed, basis.size(), 1.02 * top / (kMost - 1.0));
  result.knots = static_cast<std::size_t>(knots_needed);
  return result;
}

UnknownsOptions UnknownsOptions::of_records(double sample_rate, const ModalBasis& basis) const {
  constexpr double kGainWidth = 0.02, kDelayWidth = 1.0, kCornerWidth = 1.0;  // 1; samples; Hz
  UnknownsOptions known = *this;
  known.tests = true;
  if (damping_choice(damping) == DampingChoice::kAuto) {
    known.damping = "each";
    if (damping_width == UnknownsOptions().damping_width) known.damping_width = 1.0;
    if (std::isnan(damping_scatter)) known.damping_scatter = std::min(0.3, known.damping_width);
  }
  const bool named = sensors().may_differ();
  known.response.free = !exact_sensors && (response.free || !named);
  if (known.response.free) known.response = known.response.laid_out(basis);
  if (exact_sensors || named) return known;
  const auto release = [&](Sensor::Index i, double width) {
    known.sensor[i].free = true;
    known.priors.push_back({std::string(sensor_type(i).name), known.sensor[i].value, width});
  };
  release(Sensor::kGain, kGainWidth);
  release(Sensor::kDelay, kDelayWidth / sample_rate);
  release(Sensor::kCorner, kCornerWidth);
  return known;
}

void UnknownsOptions::require_found_by(std::string_view optimizer, bool has_schedule) const {
  MODCAL_REQUIRE(has_schedule || !response.free,
                 "{} does not find the sensors' response: state optimizer: staged, or leave "
                 "response out of the sensors",
                 optimizer);
  MODCAL_REQUIRE(has_schedule || !(mains > 0.0),
                 "{} does not find the lines of the mains at {:g} Hz: state optimizer: staged, or "
                 "leave mains out",
                 optimizer, mains);
}

UnknownsOptions UnknownsOptions::of_simulations(const ModalBasis& basis) const {
  UnknownsOptions known = *this;
  if (response.free) known.response = response.laid_out(basis);
  if (std::isnan(mains)) known.mains = 0.0;
  if (damping_choice(damping) == DampingChoice::kAuto) known.damping = "fixed";
  return known;
}

}  // namespace modcal
