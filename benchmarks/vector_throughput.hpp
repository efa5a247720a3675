// Speed of the machine's widest vectors: the floor under the step loops.
#pragma once

#include <cstddef>

namespace modcal {

struct VectorThroughput {
  std::size_t lanes = 0;       ///< doubles a vector, at most 8
  double multiply_add_ns = 0;  ///< time of one multiply-add of a vector, many being independent
};

/// Measures it: the best of several runs of 1e7 multiply-adds in 12 independent chains.
VectorThroughput measure_vector_throughput();

}  // namespace modcal
