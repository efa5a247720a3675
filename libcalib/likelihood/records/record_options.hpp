// What every use of the joint likelihood may be told of its records.
#pragma once

#include "libsim/base/options.hpp"

namespace modcal {

/// Visits highest_frequency [Hz], left_noise and right_noise [N]; NaN: found from model and record.
void visit_record_options(OptionVisitor& visitor, double& highest_frequency, double& left_noise,
                          double& right_noise);

/// Visits left_noise and right_noise [N] alone.
void visit_noise_levels(OptionVisitor& visitor, double& left_noise, double& right_noise);

}  // namespace modcal
