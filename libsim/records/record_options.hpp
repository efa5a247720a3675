// The `record:` section of an experiment: which channels of which file are what.
#pragma once

#include <limits>
#include <string>

#include "libsim/base/options.hpp"

namespace modcal {

/// One force channel of a recorded file.
struct RecordedForceOptions {
  std::string channel;
  double calibration = std::numeric_limits<double>::quiet_NaN();  ///< [N] per recorded 1; NaN: file
  double delay = 0.0;                                             ///< [s]
  void visit(OptionVisitor& visitor);
};

/// A recorded experiment: the reactions at one or both ends and, where it was measured, the force
/// at the contact.
struct RecordOptions {
  std::string file;
  std::string format = "auto";
  double sample_rate = std::numeric_limits<double>::quiet_NaN();  ///< [Hz]; NaN: from the file
  bool has_left = false;
  bool has_right = false;
  bool has_reference = false;
  RecordedForceOptions left;                               ///< R1, at x = 0
  RecordedForceOptions right;                              ///< R2, at x = L
  RecordedForceOptions reference;                          ///< f_c, used for scoring only
  double start = 0.0;                                      ///< [s] after the first sample
  double stop = std::numeric_limits<double>::quiet_NaN();  ///< [s]; NaN: the end
  void visit(OptionVisitor& visitor);
};

/// The `bow:` section of an experiment on a record: where the force acts.
struct ContactOptions {
  double position = std::numeric_limits<double>::quiet_NaN();  ///< x_c [m]
  void visit(OptionVisitor& visitor);
};

}  // namespace modcal
