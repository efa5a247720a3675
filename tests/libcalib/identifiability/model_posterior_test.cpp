#include "libcalib/identifiability/model_posterior.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal::model_posterior_test {
namespace {

class ModelsOfAPosterior : public testing::Test {
 protected:
  // ln f_0, B, x_c [m] and ln of the damping's factor.
  ModelPosterior of(const Eigen::Vector4d& deviation, double correlation) const {
    Eigen::Matrix4d covariance = deviation.cwiseAbs2().asDiagonal();
    covariance(0, 2) = covariance(2, 0) = correlation * deviation[0] * deviation[2];
    return {unknowns, unknowns.start(), covariance};
  }

  BowedCase bowed = bowed_case(0.03, 1e-4, 0.05);
  StringUnknowns unknowns = StringUnknowns::law(bowed.truth, 196.0, 1e-4);
};

TEST_F(ModelsOfAPosterior, HaveItsMeanAndCovariance) {
  const ModelPosterior posterior = of({1e-4, 0.0, 2e-4, 0.1}, -0.8);
  constexpr std::size_t kDraws = 2000;
  const auto models = posterior.draw(kDraws, StreamKey(1));
  ASSERT_EQ(models.size(), kDraws);
  double f = 0.0, x = 0.0, fx = 0.0, damping = 0.0;
  for (const ModelPoint& model : models) {
    const double of_f = std::log(model.basis.omega[0] / bowed.truth.basis.omega[0]) / 1e-4;
    const double of_x = (model.contact - bowed.truth.contact) / 2e-4;
    const double of_zeta = std::log(model.basis.zeta[3] / bowed.truth.basis.zeta[3]) / 0.1;
    f += of_f * of_f, x += of_x * of_x, fx += of_f * of_x, damping += of_zeta * of_zeta;
    // B has no deviation: the ratio of frequencies stays.
    EXPECT_NEAR(model.basis.omega[9] / model.basis.omega[0],
                bowed.truth.basis.omega[9] / bowed.truth.basis.omega[0], 1e-12);
  }
  // Mean squares of 2000 draws scatter by sqrt(2/2000) = 0.032; four of them.
  for (const double sum : {f, x, damping}) EXPECT_NEAR(sum / kDraws, 1.0, 0.13);
  EXPECT_NEAR(fx / kDraws, -0.8, 0.13);
}

TEST_F(ModelsOfAPosterior, AreTheSameFromTheSameKey) {
  const ModelPosterior posterior = of({1e-4, 1e-6, 2e-4, 0.1}, 0.5);
  const auto some = posterior.draw(2, StreamKey(1)), more = posterior.draw(4, StreamKey(1));
  EXPECT_EQ(some[1].basis.omega, more[1].basis.omega);
  EXPECT_EQ(some[1].contact, more[1].contact);
  EXPECT_NE(posterior.draw(2, StreamKey(2))[1].contact, some[1].contact);
}

TEST_F(ModelsOfAPosterior, AreOfStrings) {
  // Contact points a string's length about.
  const auto models = of({0.0, 0.0, 0.33, 0.0}, 0.0).draw(8, StreamKey(1));
  EXPECT_EQ(models.size(), 8u);
  for (const ModelPoint& model : models) {
    EXPECT_GT(model.contact, 0.0);
    EXPECT_LT(model.contact, 0.33);
  }
  EXPECT_TRUE(ModelPosterior().draw(8, StreamKey(1)).empty());
}

}  // namespace
}  // namespace modcal::model_posterior_test
