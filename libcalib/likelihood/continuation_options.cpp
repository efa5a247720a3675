#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/likelihood/continuation.hpp"
#include "libcalib/likelihood/record_options.hpp"

namespace modcal {

void ContinuationOptions::visit(OptionVisitor& visitor) {
  visitor.number({.key = "law_width",
                  .meaning = "relative width of the prior of f_n about the law",
                  .unit = "1",
                  .range = Range::positive(),
                  .word = "estimated"},
                 law_width);
  visit_record_options(visitor, highest_frequency, left_noise, right_noise);
  visitor.section({.key = "unknowns", .meaning = "what is free of damping and sensors"}, unknowns);
  visitor.integer({.key = "restarts",
                   .meaning = "other starts tried while the fit is contradicted by the data",
                   .range = Range::closed(0.0, 4.0)},
                  restarts);
}

double likelihood_band(const ModelPoint& point, double highest_frequency, double sample_rate) {
  const double top = *std::max_element(point.basis.omega.begin(), point.basis.omega.end());
  const double highest =
      std::isnan(highest_frequency) ? 1.05 * top : 2.0 * std::numbers::pi * highest_frequency;
  // Above 0.4 f_s the aliases of the force's jumps are no longer small.
  return std::min(highest, 0.8 * std::numbers::pi * sample_rate);
}

}  // namespace modcal
