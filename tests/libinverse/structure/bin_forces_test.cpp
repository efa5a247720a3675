// Forces of one bin against the covariance of its sensors, inverted as a whole.
#include "libinverse/structure/bin_forces.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "libsim/base/random.hpp"

namespace modcal::bin_forces_test {
namespace {

using Eigen::Index;

constexpr Index kSensors = 5, kOthers = 2;
constexpr double kFree = 1e5;  // power of a force of which next to nothing is known

// One bin, all of it drawn.
struct Bin {
  ContourSpectra spectra{.bins = {1, 2}};
  Transfers transfers;
  BinVariances variances;
  Eigen::VectorXcd y, h;
  Eigen::MatrixXcd others;  // kSensors x kOthers
  Eigen::VectorXd noise, powers;

  Bin() : y(kSensors), h(kSensors), others(kSensors, kOthers), noise(kSensors), powers(kOthers) {
    std::vector<double> normal(2 * kSensors * (kOthers + 2));
    fill_standard_normal(StreamKey(5), normal);
    std::size_t at = 0;
    const auto number = [&] {
      at += 2;
      return Complex(normal[at - 2], normal[at - 1]);
    };
    powers << 0.7, 30.0;
    for (Index q = 0; q < kOthers; ++q) {
      OtherForce other{.power = {powers[q]}};
      for (Index k = 0; k < kSensors; ++k) {
        other.transfers.push_back({others(k, q) = number()});
      }
      variances.others.push_back(other);
    }
    for (Index k = 0; k < kSensors; ++k) {
      spectra.responses.push_back({y[k] = number()});
      transfers.push_back({h[k] = number()});
      variances.of.push_back({noise[k] = 0.1 + 0.1 * static_cast<double>(k)});
    }
  }
  // Of the sensors, the force itself being of this power, too.
  Eigen::MatrixXcd covariance(double power) const {
    const Eigen::MatrixXcd diagonal = noise.cast<Complex>().asDiagonal();
    return diagonal + others * powers.asDiagonal() * others.adjoint() + power * h * h.adjoint();
  }
  BinForces found(std::size_t left_out) const {
    return {spectra, transfers, variances, left_out, 0};
  }
};

// Both ways round some 1e-14 of their terms, which are up to 1e3 times what is left of them.
constexpr double kRounding = 1e-10;

TEST(BinForces, TellWhatTheWholeCovarianceTells) {
  const Bin bin;
  const Eigen::MatrixXcd inverse = bin.covariance(0.0).inverse();
  const BinForces found = bin.found(kNoSensor);
  EXPECT_NEAR(found.told() / bin.h.dot(inverse * bin.h).real(), 1.0, kRounding);
  EXPECT_LT(std::abs(found.score() - bin.h.dot(inverse * bin.y)),
            kRounding * std::abs(found.score()));
  // F_q = P Aᴴ S⁻¹ (y − hF) of the others.
  const Eigen::VectorXcd rest = bin.y - bin.h * found.force();
  const Eigen::VectorXcd others =
      bin.powers.asDiagonal() * (bin.others.adjoint() * (inverse * rest));
  for (Index k = 0; k < kSensors; ++k) {
    const Complex left = rest[k] - (bin.others.row(k) * others).value();
    EXPECT_LT(std::abs(found.left(static_cast<std::size_t>(k), found.force()) - left), kRounding);
  }
}

// S_kr S_rr⁻¹ y_r and its variance; 1/kFree of them is what the force is still known by, and 1e-16
// kFree² of rounding, in numbers of about one.
TEST(BinForces, PredictASensorFromTheOthers) {
  const Bin bin;
  const Eigen::MatrixXcd whole = bin.covariance(kFree);
  for (Index k = 0; k < kSensors; ++k) {
    std::vector<Index> kept;
    for (Index j = 0; j < kSensors; ++j) {
      if (j != k) kept.push_back(j);
    }
    const Eigen::MatrixXcd inverse = whole(kept, kept).inverse();
    const Eigen::RowVectorXcd row = whole(k, kept) * inverse;
    const Complex predicted = (row * bin.y(kept)).value();
    const double variance = (whole(k, k) - (row * whole(kept, k)).value()).real() - bin.noise[k];
    const auto sensor = static_cast<std::size_t>(k);
    const BinForces found = bin.found(sensor);
    EXPECT_LT(std::abs(bin.y[k] - found.left(sensor, found.force()) - predicted), 1e-4);
    EXPECT_NEAR(found.variance(sensor) / variance, 1.0, 1e-4);
  }
}

}  // namespace
}  // namespace modcal::bin_forces_test
