// A sampled physical quantity.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace modcal {

struct Signal {
  std::string quantity;      ///< what it is: "R1", "R2", "f_c", "y", "v", …
  std::string unit;          ///< SI unit: "N", "m", "m/s"
  double sample_rate = 0.0;  ///< [Hz]
  std::vector<double> samples;

  std::size_t size() const { return samples.size(); }
  double duration() const { return static_cast<double>(samples.size()) / sample_rate; }
};

}  // namespace modcal
