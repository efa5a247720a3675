// Figures as an experiment asks for them.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "libsim/base/options.hpp"

namespace modcal {

/// Interval of the time axis [s].
struct TimeWindow {
  double start = 0.0;
  double stop = std::numeric_limits<double>::quiet_NaN();
  void visit(OptionVisitor& visitor);
};

/// One figure: what it shows and of which part. Rows are quantities × windows, columns the two
/// ends.
struct FigureOptions {
  std::string id;
  std::string title;
  std::string content = "waveforms";
  std::vector<std::string> quantities = {"y", "v", "f_c"};
  std::vector<TimeWindow> windows;
  std::int64_t modes = 12;
  double lowest_frequency = 20.0;
  double highest_frequency = std::numeric_limits<double>::quiet_NaN();
  void visit(OptionVisitor& visitor);
};

}  // namespace modcal
