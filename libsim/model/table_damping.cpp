#include "libsim/model/table_damping.hpp"

#include <algorithm>
#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal {

void TableDamping::Options::visit(OptionVisitor& visitor) {
  visitor.numbers({.key = "frequencies",
                   .meaning = "frequencies of the points, strictly rising",
                   .unit = "Hz",
                   .range = Range::non_negative(),
                   .required = true},
                  frequencies);
  visitor.numbers({.key = "ratios",
                   .meaning = "damping ratios at these frequencies",
                   .unit = "1",
                   .range = {0.0, 1.0, true, false},
                   .required = true},
                  ratios);
}

TableDamping::TableDamping(Options options) : options_(std::move(options)) {
  const std::vector<double>& f = options_.frequencies;
  MODCAL_REQUIRE(f.size() == options_.ratios.size() && !f.empty(),
                 "{} frequencies and {} damping ratios were given: each frequency needs one ratio",
                 f.size(), options_.ratios.size());
  for (std::size_t i = 1; i < f.size(); ++i) {
    MODCAL_REQUIRE(f[i] > f[i - 1],
                   "the frequencies of a damping table must rise, but {:g} Hz follows {:g} Hz",
                   f[i], f[i - 1]);
  }
}

double TableDamping::ratio(const DampedMode& mode) const {
  const std::vector<double>&f = options_.frequencies, &zeta = options_.ratios;
  const double frequency = mode.omega / (2.0 * std::numbers::pi);
  const auto after =
      static_cast<std::size_t>(std::upper_bound(f.begin(), f.end(), frequency) - f.begin());
  if (after == 0) return zeta.front();
  if (after == f.size()) return zeta.back();
  const double share = (frequency - f[after - 1]) / (f[after] - f[after - 1]);
  return zeta[after - 1] + share * (zeta[after] - zeta[after - 1]);
}

}  // namespace modcal
