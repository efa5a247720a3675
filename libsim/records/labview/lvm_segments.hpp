// The segments of a LabVIEW measurement file.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "libsim/records/universal/line_file.hpp"

namespace modcal {

/// One channel of a segment, its values in their order.
struct LvmChannel {
  std::string name, unit;
  std::size_t announced = 0;                                ///< samples
  double step = 1.0;                                        ///< Delta_X
  std::string step_text = {};                               ///< as it was printed, with a point
  double origin = 0.0;                                      ///< X0
  double start = std::numeric_limits<double>::quiet_NaN();  ///< date and time [s]
  bool in_time = true;
  bool has_gaps = false;                  ///< rows without a value that no other rate explains
  bool is_miscounted = false;             ///< more samples than its share of the packets announced
  std::vector<double> samples, instants;  ///< instants: empty without a column X
  double instant_resolution = 0.0;        ///< absolute, as they were printed [s]
};

struct LvmSegment {
  std::vector<LvmChannel> channels;
  std::size_t line = 0;  ///< where it begins
  std::size_t rows = 0;  ///< estimated where headers alone were read
  bool is_estimated = false;
  /// As write_lvm() left it in the notes; NaN: another's file.
  double stated_rate = std::numeric_limits<double>::quiet_NaN();
};

/// All segments, or the first one without values. Throws InvalidInput as read_lvm() says.
std::vector<LvmSegment> read_lvm_segments(const std::filesystem::path& path, bool headers_only);

/// Before the sample rate to its last digit, in the notes of a segment by write_lvm().
inline constexpr std::string_view kLvmRate = "sample_rate: ";

}  // namespace modcal
