#include "libsim/model/string_model.hpp"

#include <cmath>

namespace modcal {

StringModel StringModel::before_reading() const {
  StringModel string = *this;
  if (string.modes_of_record()) string.modes = StringModel().modes;
  return string;
}

void StringModel::visit(OptionVisitor& visitor) {
  visitor.number({.key = "length",
                  .meaning = "vibrating length L",
                  .unit = "m",
                  .range = Range::positive(),
                  .required = true},
                 length);
  visitor.number({.key = "linear_density",
                  .meaning = "mass per length",
                  .unit = "kg/m",
                  .range = Range::positive(),
                  .required = true},
                 linear_density);
  visitor.number({.key = "fundamental",
                  .meaning = "fundamental f0 of the string without stiffness",
                  .unit = "Hz",
                  .range = Range::positive(),
                  .required = true},
                 fundamental);
  visitor.number({.key = "inharmonicity",
                  .meaning = "B of f_n = n f0 sqrt(1 + B n^2)",
                  .unit = "1",
                  .range = Range::non_negative()},
                 inharmonicity);
  visitor.integer({.key = "modes",
                   .meaning = "number of modes N; auto, for a record: those below 0.4 sampling "
                              "rates that stand out of its noise",
                   .range = Range::closed(1, 5000),
                   .word = "auto"},
                  modes);
  visitor.plugin({.key = "damping", .meaning = "modal damping law"}, damping);
}

double stiff_string_frequency(double fundamental, double inharmonicity, std::size_t n) {
  const double order = static_cast<double>(n);
  return order * fundamental * std::sqrt(1.0 + inharmonicity * order * order);
}

std::int64_t modes_below(const StringModel& string, double highest) {
  std::int64_t count = 0;
  const auto frequency = [&](std::int64_t n) {
    return stiff_string_frequency(string.fundamental, string.inharmonicity,
                                  static_cast<std::size_t>(n));
  };
  while (frequency(count + 1) < highest) ++count;
  return count;
}

}  // namespace modcal
