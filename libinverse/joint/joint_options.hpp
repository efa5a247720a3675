// What all estimators on both reactions have to be told.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "libinverse/joint/joint_inversion.hpp"
#include "libsim/base/options.hpp"

namespace modcal {

/// Section "inversion" of an estimator on both reactions.
struct JointOptions {
  std::string truncation = "auto";
  double sigma = std::numeric_limits<double>::quiet_NaN();  ///< [1/s]; NaN: see contour_of
  std::string offset = "arrival";
  /// Standard deviations of the noise of one sample [N]; NaN: from the record.
  double noise_rms[2] = {std::numeric_limits<double>::quiet_NaN(),
                         std::numeric_limits<double>::quiet_NaN()};
  /// [Hz]; NaN: three modes below the highest for recorded data, none for a simulation.
  double band_limit = std::numeric_limits<double>::quiet_NaN();
  bool limit_to_top_mode = false;
  std::int64_t points = 100;
  SupportOptions transfer = {};
  SensorPair sensors = {};

  void visit(OptionVisitor& visitor);
  /// Throws InvalidInput for options out of range.
  void require() const;
};

/// Throw InvalidInput for an unknown name. None of "auto": by the record.
std::optional<Truncation> truncation_of(const std::string& name);
OffsetRule offset_rule_of(const std::string& name);

}  // namespace modcal
