// What a search may spend.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>

#include "libsim/base/options.hpp"

namespace modcal {

struct Budget {
  std::int64_t evaluations = 100000;  ///< candidates of a scan count one each
  /// Time after which no evaluation starts [s]; NaN: no limit.
  double seconds = std::numeric_limits<double>::quiet_NaN();
  /// Value at or below which the search ends; NaN: no target.
  double target = std::numeric_limits<double>::quiet_NaN();

  void visit(OptionVisitor& visitor);
  /// Throws InvalidInput for fewer than one evaluation or a time that is not positive.
  void require_valid() const;
};

/// Clock in seconds; any origin. Read before every evaluation; what it throws (Interrupted, say)
/// ends the search and comes out of it.
using SecondsClock = std::function<double()>;
SecondsClock steady_seconds();

}  // namespace modcal
