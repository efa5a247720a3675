// A part of a task list, for runs that share one list.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace modcal {

/// Part K of N: the tasks i with i mod N = K − 1. A Slurm array, MPI ranks and a laptop all use it.
struct Shard {
  std::size_t index = 1;  ///< K, 1 ≤ K ≤ N
  std::size_t count = 1;  ///< N

  bool is_whole() const { return count == 1; }
  bool holds(std::size_t task) const { return task % count == index - 1; }
  std::size_t size(std::size_t tasks) const { return (tasks + count - index) / count; }
  /// "2/7", as on the command line.
  std::string text() const;
};

/// Reads "K/N". Throws InvalidInput for anything else and for K outside 1…N.
Shard parse_shard(std::string_view text);

}  // namespace modcal
