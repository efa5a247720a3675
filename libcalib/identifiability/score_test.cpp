// What follows from the score test of a cause.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libcalib/identifiability/misfit_causes.hpp"
#include "libcalib/identifiability/tuning.hpp"

namespace modcal {

Eigen::VectorXd ScoreTest::suspected() const { return suspicion() * moved; }

double ScoreTest::suspicion() const {
  return std::sqrt(std::max(0.0, 1.0 - 2.0 * std::exp(log_p)));
}

bool ScoreTest::moves_modes_off_law() const { return cause == kBridge; }

bool ScoreTest::refuses() const {
  // Where the contact moves, what is of second order in how far adds to what the test foretells.
  const double most = cause == kContact ? 1.0 : 2.0;
  return named() && (contradiction > most || coupling > kMostCoupling);
}

bool ScoreTest::frees() const {
  return cause == kDrift || cause == kResonance ||
         (cause == kBridge && coupling < kMostCouplingTaken);
}

std::string_view ScoreTest::remedy() const {
  constexpr std::pair<std::string_view, std::string_view> kRemedies[] = {
      {kPolarization,
       "the string moves across the plane of the sensors, too: bow it in that plane, or turn the "
       "sensors"},
      {kDrift, "record when the string has settled, or calibrate a shorter part of the record"},
      {kNonlinear, "play softer, or use sensors of a wider range"},
      {kResonance,
       "fix the sensor more stiffly, or end the band below its resonance (highest_frequency)"},
      {kContact,
       "the bow wanders along the string: guide it, or calibrate a part of the record in which it "
       "stays in place (record.start, record.stop)"},
      {kBridge, "clamp the bridge or load it, or mount the string on heavier supports"},
      {kModesAbove,
       "the record has not the modes above those stated that the law has: state more modes, or "
       "calibration: {remainder: none} for a simulated record of exactly so many"}};
  for (const auto& [name, text] : kRemedies) {
    if (cause == name) return text;
  }
  return "";
}

std::string bridge_detail(double place, double inverse_mass) {
  if (!(inverse_mass > 0.0)) return fmt::format("at {:.0f} Hz", place);
  return fmt::format("at {:.0f} Hz, of {:.3g} kg", place, 1.0 / inverse_mass);
}

const ScoreTest* first_cause(const std::vector<ScoreTest>& tests) {
  const auto least = std::ranges::min_element(tests, {}, &ScoreTest::log_p);
  return least == tests.end() || !least->named() ? nullptr : &*least;
}

}  // namespace modcal
