#include "libcalib/likelihood/records/record_options.hpp"

namespace modcal {

void visit_record_options(OptionVisitor& visitor, double& highest_frequency, double& left_noise,
                          double& right_noise) {
  visitor("highest_frequency",
          "highest frequency used, not above 0.4 sampling rates; automatic: 5 % above "
          "the highest mode",
          {.unit = "Hz", .range = Range::positive(), .word = "automatic"}, highest_frequency);
  visit_noise_levels(visitor, left_noise, right_noise);
}

void visit_noise_levels(OptionVisitor& visitor, double& left_noise, double& right_noise) {
  visitor("noise_rms_1", "noise standard deviation of the reaction at x = 0",
          {.unit = "N", .range = Range::positive(), .word = "estimated"}, left_noise);
  visitor("noise_rms_2", "noise standard deviation of the reaction at x = L",
          {.unit = "N", .range = Range::positive(), .word = "estimated"}, right_noise);
}

}  // namespace modcal
