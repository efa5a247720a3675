#include "libsim/base/random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <thread>
#include <vector>

namespace modcal::random_test {
namespace {

constexpr std::size_t kCount = 200000;

std::vector<double> normals(const StreamKey& key, std::size_t count = kCount) {
  std::vector<double> values(count);
  fill_standard_normal(key, values);
  return values;
}

double moment(const std::vector<double>& values, int power) {
  double sum = 0.0;
  for (const double value : values) sum += std::pow(value, power);
  return sum / static_cast<double>(values.size());
}

TEST(StandardNormal, ElementDependsOnKeyAndIndexAlone) {
  const StreamKey key(1);
  const std::vector<double> whole = normals(key, 1003);
  for (const std::size_t count : {0, 1, 2, 3, 4, 5, 6, 7, 8, 500}) {
    const std::vector<double> part = normals(key, count);
    EXPECT_TRUE(std::equal(part.begin(), part.end(), whole.begin())) << count;
  }
}

TEST(StandardNormal, IsTheSameFromEveryThreadAndInEveryOrder) {
  std::vector<std::vector<double>> backwards(8);
  std::vector<std::thread> threads;
  for (std::size_t i = backwards.size(); i-- > 0;) {
    threads.emplace_back(
        [&, i] { backwards[i] = normals(StreamKey(3).with(std::uint64_t{i}), 999); });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < backwards.size(); ++i) {
    EXPECT_EQ(backwards[i], normals(StreamKey(3).with(std::uint64_t{i}), 999));
  }
}

TEST(StandardNormal, HasTheMomentsOfANormalDistribution) {
  const std::vector<double> values = normals(StreamKey(5));
  // Standard errors of the first four moments: √(1, 2, 15, 96)/√n; five of them.
  const double unit = 5.0 / std::sqrt(static_cast<double>(kCount));
  EXPECT_NEAR(moment(values, 1), 0.0, unit);
  EXPECT_NEAR(moment(values, 2), 1.0, unit * std::sqrt(2.0));
  EXPECT_NEAR(moment(values, 3), 0.0, unit * std::sqrt(15.0));
  EXPECT_NEAR(moment(values, 4), 3.0, unit * std::sqrt(96.0));
}

TEST(StandardNormal, HasNoCorrelationBetweenNeighbors) {
  const std::vector<double> values = normals(StreamKey(6));
  for (const std::size_t lag : {1, 2, 3, 4, 8}) {
    double sum = 0.0;
    for (std::size_t i = lag; i < kCount; ++i) sum += values[i] * values[i - lag];
    EXPECT_LT(std::abs(sum), 5.0 * std::sqrt(static_cast<double>(kCount))) << lag;
  }
}

TEST(StandardNormal, StreamsOfDifferentKeysAreIndependent) {
  const std::vector<double> x = normals(StreamKey(7).with("noise"));
  const std::vector<double> y = normals(StreamKey(7).with("noisf"));
  double product = 0.0;
  for (std::size_t i = 0; i < kCount; ++i) product += x[i] * y[i];
  EXPECT_LT(std::abs(product), 5.0 * std::sqrt(static_cast<double>(kCount)));
}

TEST(Uniform, FillsTheIntervalEvenly) {
  std::vector<double> values(kCount);
  fill_uniform(StreamKey(8), values);
  std::vector<int> counts(20);
  for (const double value : values) {
    ASSERT_GT(value, 0.0);
    ASSERT_LE(value, 1.0);
    ++counts[std::min<std::size_t>(19, static_cast<std::size_t>(20.0 * value))];
  }
  const double expected = kCount / 20.0;
  for (const int count : counts) EXPECT_NEAR(count, expected, 5.0 * std::sqrt(expected));
}

TEST(StreamKey, DiffersWhereverItsInputsDiffer) {
  const StreamKey key(9);
  std::set<std::uint64_t> values = {
      key.value(),
      StreamKey(10).value(),
      key.with("a").value(),
      key.with("ab").value(),
      key.with("ba").value(),
      key.with("a").with("b").value(),
      key.with("b").with("a").value(),
      key.with(std::uint64_t{0}).value(),
      key.with(std::uint64_t{1}).value(),
      key.with(1.0).value(),
      key.with(std::nextafter(1.0, 2.0)).value(),
      key.with(std::uint64_t{1}).with(std::uint64_t{2}).value(),
      key.with(std::uint64_t{2}).with(std::uint64_t{1}).value(),
  };
  EXPECT_EQ(values.size(), 13u);
  for (std::uint64_t seed = 0; seed < 10000; ++seed) values.insert(key.with(seed).value());
  EXPECT_EQ(values.size(), 13u + 10000u - 2u);  // 0 and 1 were there
}

TEST(StreamKey, TakesBothZerosForOneNumber) {
  EXPECT_EQ(StreamKey(1).with(0.0).value(), StreamKey(1).with(-0.0).value());
}

}  // namespace
}  // namespace modcal::random_test
