#include "benchmarks/vector_throughput.hpp"

#include <algorithm>
#include <ctime>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "benchmarks/vector_throughput.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

double RunChains(std::size_t rounds, std::size_t* lanes) {
  constexpr std::size_t kChains = 12;
  const hn::CappedTag<double, 8> d;
  *lanes = hn::Lanes(d);
  const auto factor = hn::Set(d, 0.999999), term = hn::Set(d, 1e-6);
  hn::Vec<decltype(d)> chain[kChains];
  for (std::size_t c = 0; c < kChains; ++c) chain[c] = hn::Set(d, static_cast<double>(c));
  for (std::size_t r = 0; r < rounds; ++r) {
    for (std::size_t c = 0; c < kChains; ++c) chain[c] = hn::MulAdd(chain[c], factor, term);
  }
  auto sum = hn::Zero(d);
  for (std::size_t c = 0; c < kChains; ++c) sum = hn::Add(sum, chain[c]);
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(RunChains);

VectorThroughput measure_vector_throughput() {
  constexpr std::size_t kRounds = 800'000;
  VectorThroughput result{.multiply_add_ns = 1e9};
  volatile double sink = 0.0;
  for (int repeat = 0; repeat < 10; ++repeat) {
    const std::clock_t start = std::clock();
    sink = sink + HWY_DYNAMIC_DISPATCH(RunChains)(kRounds, &result.lanes);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    result.multiply_add_ns = std::min(result.multiply_add_ns, 1e9 * seconds / (12.0 * kRounds));
  }
  return result;
}

}  // namespace modcal
#endif
