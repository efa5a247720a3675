// Noise of the sensors.
#include <cmath>
#include <numbers>

#include "benchmarks/truth/truth.hpp"

namespace modcal::truth {
namespace {

/// Counter-based: draw i of a channel depends on nothing else (SplitMix64; Steele, Lea and Flood,
/// 2014).
double uniform(std::uint64_t seed, std::uint64_t counter) {
  std::uint64_t z = seed * 0xD1342543DE82EF95u + (counter + 1) * 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  z ^= z >> 31;
  return (static_cast<double>(z >> 11) + 0.5) * 0x1.0p-53;
}

double deviation(const std::vector<double>& samples) {
  double mean = 0.0, square = 0.0;
  for (const double x : samples) mean += x / static_cast<double>(samples.size());
  for (const double x : samples) square += (x - mean) * (x - mean);
  return std::sqrt(square / static_cast<double>(samples.size()));
}

}  // namespace

void add_noise(TruthRecord& record, double level, std::uint64_t seed) {
  std::vector<double>* const channels[] = {&record.r1, &record.r2};
  for (std::uint64_t c = 0; c < 2; ++c) {
    record.noise[c] = level * deviation(*channels[c]);
    for (std::size_t i = 0; i < channels[c]->size(); ++i) {
      const double radius = std::sqrt(-2.0 * std::log(uniform(2 * seed + c, 2 * i)));
      const double turn = 2.0 * std::numbers::pi * uniform(2 * seed + c, 2 * i + 1);
      (*channels[c])[i] += record.noise[c] * radius * std::cos(turn);
    }
  }
}

}  // namespace modcal::truth
