// How far a further strike is off, on draws of strikes whose scatter is known.
#include "libinverse/structure/strikes/pole_scatter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"

namespace modcal::pole_scatter_test {
namespace {

using Eigen::Index;

constexpr Index kModes = 16;

// What a strike's values are off by: alike for all modes, of each by itself, and by noise.
struct Scatter {
  double alike, own, noise;
};

Eigen::VectorXd strike_of(const Scatter& scatter, const StreamKey& key) {
  std::vector<double> z(2 * kModes + 1);
  fill_standard_normal(key, z);
  Eigen::VectorXd values(kModes);
  for (Index n = 0; n < kModes; ++n) {
    const auto i = static_cast<std::size_t>(2 * n);
    values[n] = scatter.alike * z[2 * kModes] + scatter.own * z[i] + scatter.noise * z[i + 1];
  }
  return values;
}

// Share of further strikes' modes within 1.96 deviations of the strikes' mean.
double coverage(Index strikes, const Scatter& scatter) {
  constexpr std::uint64_t kDraws = 400;
  Index inside = 0;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    const StreamKey key = StreamKey(draw).with("strike");
    Eigen::MatrixXd values(strikes, kModes);
    for (Index i = 0; i < strikes; ++i) {
      values.row(i) = strike_of(scatter, key.with(static_cast<std::uint64_t>(i)));
    }
    const Eigen::VectorXd told =
        Eigen::VectorXd::Constant(kModes, scatter.noise / std::sqrt(static_cast<double>(strikes)));
    const FurtherStrike further = further_strike(values, told, values.colwise().mean());
    const Eigen::VectorXd off =
        values.colwise().mean().transpose() - strike_of(scatter, key.with("further"));
    inside += (off.array().abs() < 1.96 * further.deviations.array()).count();
  }
  return static_cast<double>(inside) / static_cast<double>(kDraws * kModes);
}

// Where the two parts are alike large, widening each by its own t makes the sum a little too wide.
TEST(PoleScatter, HoldsAFurtherStrike) {
  for (const Index strikes : {2, 3, 5, 8}) {
    for (const Scatter& scatter :
         {Scatter{0.0, 1e-3, 1e-5}, Scatter{1e-3, 1e-4, 1e-5}, Scatter{1e-3, 1e-3, 1e-5},
          Scatter{0.0, 0.0, 1e-3}, Scatter{1e-3, 1e-4, 1e-3}}) {
      const double share = coverage(strikes, scatter);
      EXPECT_GT(share, 0.92) << strikes << " " << scatter.alike << " " << scatter.own;
      EXPECT_LT(share, 0.995) << strikes << " " << scatter.alike << " " << scatter.own;
    }
  }
}

TEST(PoleScatter, OfAModeThatMovesMoreThanOthersIsItsOwn) {
  constexpr Index kStrikes = 6;
  Eigen::MatrixXd values(kStrikes, kModes);
  for (Index i = 0; i < kStrikes; ++i) {
    values.row(i) = strike_of({0.0, 1e-4, 0.0}, StreamKey(7).with(static_cast<std::uint64_t>(i)));
  }
  const Eigen::VectorXd told = Eigen::VectorXd::Constant(kModes, 1e-6);
  const Eigen::VectorXd before = further_strike(values, told, values.colwise().mean()).deviations;
  values.col(3) *= 50.0;
  const FurtherStrike moved = further_strike(values, told, values.colwise().mean());
  // Its own variance counts at least 5 of the degrees of freedom, all have 80 at most.
  EXPECT_GT(moved.deviations[3], 10.0 * before[3]);
  for (const Index n : {0, 7, 15}) {
    EXPECT_NEAR(moved.deviations[n] / before[n], 1.0, 0.5);
  }
  EXPECT_NEAR(moved.scatters[3] / 50.0,
              std::sqrt((values.col(3).array() - values.col(3).mean()).square().sum() / 5.0) / 50.0,
              1e-12);
}

TEST(PoleScatter, HoldsWhatTheFitToAllIsOffTheirMean) {
  Eigen::MatrixXd values(4, kModes);
  for (Index i = 0; i < 4; ++i) {
    values.row(i) = strike_of({0.0, 1e-4, 0.0}, StreamKey(9).with(static_cast<std::uint64_t>(i)));
  }
  const Eigen::VectorXd told = Eigen::VectorXd::Constant(kModes, 1e-6);
  Eigen::VectorXd common = values.colwise().mean();
  const Eigen::VectorXd before = further_strike(values, told, common).deviations;
  common[2] += 5e-3;
  const Eigen::VectorXd after = further_strike(values, told, common).deviations;
  EXPECT_NEAR(after[2], std::hypot(before[2], 5e-3), 1e-12);
  EXPECT_EQ(after[3], before[3]);
}

TEST(PoleScatter, OfOneStrikeIsRefused) {
  const Eigen::VectorXd three = Eigen::VectorXd::Ones(3), two = Eigen::VectorXd::Ones(2);
  EXPECT_THROW(further_strike(Eigen::MatrixXd::Zero(1, 3), three, three), InvalidInput);
  EXPECT_THROW(further_strike(Eigen::MatrixXd::Zero(2, 3), two, three), InvalidInput);
  EXPECT_THROW(further_strike(Eigen::MatrixXd::Zero(2, 3), three, two), InvalidInput);
}

}  // namespace
}  // namespace modcal::pole_scatter_test
