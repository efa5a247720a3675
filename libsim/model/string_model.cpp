#include "libsim/model/string_model.hpp"

#include <cmath>

namespace modcal {

StringModel StringModel::before_reading() const {
  StringModel string = *this;
  if (string.modes_of_record()) string.modes = StringModel().modes;
  return string;
}

void StringModel::visit(OptionVisitor& visitor) {
  visitor("length", "vibrating length L",
          {.unit = "m", .range = Range::positive(), .required = true}, length);
  visitor("linear_density", "mass per length",
          {.unit = "kg/m", .range = Range::positive(), .required = true}, linear_density);
  visitor("fundamental", "fundamental f0 of the string without stiffness",
          {.unit = "Hz", .range = Range::positive(), .required = true}, fundamental);
  visitor("inharmonicity", "B of f_n = n f0 sqrt(1 + B n^2)", {.range = Range::non_negative()},
          inharmonicity);
  visitor("modes",
          "number of modes N; auto, for a record: those below 0.4 sampling "
          "rates that stand out of its noise",
          {.range = Range::closed(1, 5000), .word = "auto"}, modes);
  visitor("damping", "modal damping law", damping);
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
