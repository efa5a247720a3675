#include "libcalib/problem/budget.hpp"

#include <chrono>
#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {

void Budget::visit(OptionVisitor& visitor) {
  visitor("evaluations", "evaluations of the objective allowed", {.range = Range::at_least(1)},
          evaluations);
  visitor("seconds", "time after which no evaluation starts",
          {.unit = "s", .range = Range::positive(), .word = "unlimited"}, seconds);
  visitor("target", "value of the objective at which the search ends", {.word = "none"}, target);
}

void Budget::require_valid() const {
  MODCAL_REQUIRE(evaluations >= 1, "a budget of {} evaluations allows nothing: give at least 1",
                 evaluations);
  MODCAL_REQUIRE(std::isnan(seconds) || seconds > 0.0, "a time budget of {:g} s allows nothing",
                 seconds);
}

SecondsClock steady_seconds() {
  return [] {
    using namespace std::chrono;
    return duration<double>(steady_clock::now().time_since_epoch()).count();
  };
}

}  // namespace modcal
