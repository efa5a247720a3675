#include <gtest/gtest.h>

#include <cmath>

#include "experiments/study/observation.hpp"
#include "libsim/base/error.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::model_error_test {
namespace {

TEST(WithErrors, DrawsEveryFrequencyWithinTheStatedError) {
  const ModalBasis truth = make_modal_basis(paper_scene().string);
  const AssumedModel model =
      with_errors(truth, 0.03, {.frequencies = 0.02}, StreamKey(1).with("model error"));
  double largest = 0.0;
  int above = 0;
  for (std::size_t n = 0; n < truth.size(); ++n) {
    const double error = model.basis.omega[n] / truth.omega[n] - 1.0;
    EXPECT_LE(std::abs(error), 0.02);
    largest = std::max(largest, std::abs(error));
    if (error > 0.0) ++above;
  }
  EXPECT_GT(largest, 0.015);  // 50 uniform draws all below 3/4: probability 6e-7
  EXPECT_GT(above, 5);        // both signs: binomial(50, 1/2) at or below 5 has 2e-9
  EXPECT_LT(above, 45);
  EXPECT_EQ(model.basis.zeta, truth.zeta);
  EXPECT_EQ(model.contact, 0.03);
}

TEST(WithErrors, ShiftsContactAndDamping) {
  const ModalBasis truth = make_modal_basis(paper_scene().string);
  const AssumedModel model =
      with_errors(truth, 0.03, {.damping = 0.5, .contact = -1.5e-3}, StreamKey(1));
  EXPECT_EQ(model.basis.omega, truth.omega);
  EXPECT_DOUBLE_EQ(model.basis.zeta[7], 1.5e-3);
  EXPECT_DOUBLE_EQ(model.contact, 28.5e-3);
}

TEST(WithErrors, RefusesAContactOutsideTheString) {
  const ModalBasis truth = make_modal_basis(paper_scene().string);
  EXPECT_THROW(with_errors(truth, 0.03, {.contact = -0.04}, StreamKey(1)), InvalidInput);
  EXPECT_THROW(with_errors(truth, 0.03, {.contact = 0.4}, StreamKey(1)), InvalidInput);
  EXPECT_THROW(with_errors(truth, 0.03, {.damping = 2000.0}, StreamKey(1)), InvalidInput);
}

}  // namespace
}  // namespace modcal::model_error_test
