// Equal samples that follow one another.
#pragma once

#include <cstddef>
#include <span>

namespace modcal {

struct Run {
  std::size_t first = 0, count = 0;
  std::size_t end() const { return first + count; }
};

/// Calls visit(Run) for every run of samples, those of one sample too, in their order.
template <typename Visit>
void for_each_run(std::span<const double> samples, Visit visit) {
  for (std::size_t first = 0; first < samples.size();) {
    std::size_t end = first + 1;
    while (end < samples.size() && samples[end] == samples[first]) ++end;
    visit(Run{first, end - first});
    first = end;
  }
}

}  // namespace modcal
