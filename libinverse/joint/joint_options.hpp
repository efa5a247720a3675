// What all estimators on both reactions have to be told.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "libinverse/joint/joint_inversion.hpp"
#include "libsim/base/options.hpp"

namespace modcal {

/// What a transfer function holds besides the stated modes.
struct TransferOptions {
  /// "on": modes above the highest stated one answer statically; "off": they do not exist, as in a
  /// simulated string of that many modes; "auto": on for recorded data.
  std::string static_remainder = "auto";
  /// The support feels T y_x − E I y_xxx instead of T y_x: g_rn times (1 + B n²).
  bool bending = false;

  void visit(OptionVisitor& visitor);
  /// `recorded`: the data are no simulation.
  StringSupport support(bool recorded) const {
    return {
        .static_remainder = static_remainder == "on" || (static_remainder == "auto" && recorded),
        .bending = bending};
  }
};

/// Section "inversion" of an estimator on both reactions.
struct JointOptions {
  std::string truncation = "shifted_contour";
  double sigma = std::numeric_limits<double>::quiet_NaN();  ///< [1/s]; NaN: see contour_of
  std::string offset = "arrival";
  /// Standard deviations of the noise of one sample [N]; NaN: from the record.
  double noise_rms[2] = {std::numeric_limits<double>::quiet_NaN(),
                         std::numeric_limits<double>::quiet_NaN()};
  double band_limit = std::numeric_limits<double>::quiet_NaN();  ///< [Hz]; NaN: none
  bool limit_to_top_mode = false;
  std::int64_t points = 100;
  TransferOptions transfer = {};
  SensorPair sensors = {};

  void visit(OptionVisitor& visitor);
  /// Throws InvalidInput for options out of range.
  void require() const;
};

/// Throw InvalidInput for an unknown name.
Truncation truncation_of(const std::string& name);
OffsetRule offset_rule_of(const std::string& name);

}  // namespace modcal
