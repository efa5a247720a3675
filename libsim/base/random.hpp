// Counter-based random numbers: a draw depends on its key and its index alone, never on the clock,
// the thread or the order of evaluation.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace modcal {

/// Key of an independent stream: hash of the experiment's words and numbers.
class StreamKey {
 public:
  explicit StreamKey(std::uint64_t seed);
  StreamKey with(std::string_view word) const;
  StreamKey with(std::uint64_t number) const;
  StreamKey with(double number) const;
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_;
};

/// Fills `out` with independent standard normal numbers: Philox-4x64-10 counters through the
/// Box–Muller transform (Salmon et al., 2011; Box and Muller, 1958). Element i depends on the key
/// and on i alone.
void fill_standard_normal(const StreamKey& key, std::span<double> out);

/// Fills `out` with independent uniform numbers in (0, 1].
void fill_uniform(const StreamKey& key, std::span<double> out);

}  // namespace modcal
