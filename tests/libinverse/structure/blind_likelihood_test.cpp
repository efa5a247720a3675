// The Jacobian of the blind likelihood gives the slope of its cost.
#include "libinverse/structure/blind_likelihood.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "benchmarks/problems/known_structures.hpp"

namespace modcal::blind_likelihood_test {
namespace {

using namespace known_structures;

// θ of BlindFit: ln ω and ln ζ of every mode, then real and imaginary part of every factor.
ModalModel moved(ModalModel model, std::size_t i, double step) {
  const std::size_t poles = 2 * model.poles.size();
  if (i < poles) {
    ModalPole& pole = model.poles[i / 2];
    (i % 2 == 0 ? pole.omega : pole.zeta) *= std::exp(step);
    return model;
  }
  const std::size_t j = (i - poles) / 2;
  const Complex factor = i % 2 == 0 ? Complex(1.0 + step) : Complex(1.0, step);
  const Complex constant = factor * Complex(model.constants[j], model.quadrature[j]);
  model.constants[j] = constant.real();
  model.quadrature[j] = constant.imag();
  return model;
}

class BlindLikelihoodAtRest : public testing::TestWithParam<bool> {};

TEST_P(BlindLikelihoodAtRest, JacobianIsTheSlopeOfTheCost) {
  const ModalModel truth = six_modes(3), model = started_off(truth, 3, 0.01, 0.2);
  const Noisy noisy = with_noise(clean_record(truth), 0.05, 1);
  const auto spectra = ContourSpectra::of(noisy.record, 4.0, kLow, kHigh);
  const BinVariances variances = noisy.variances(spectra);
  const BlindLikelihood likelihood(spectra, truth.sensors, variances, GetParam());
  const BlindPoint point = likelihood.at(model);
  // J = 2|e|²/κ; what a column has along h or along PX is orthogonal to e.
  const Eigen::MatrixXd jacobian = likelihood.jacobian(model, model, point, true);
  const Eigen::VectorXd slope =
      4.0 / spectra.correlated() * (jacobian.transpose() * point.residual);
  ASSERT_EQ(slope.size(), 12 + 36);
  for (std::size_t i = 0; i < 48; ++i) {
    // (step/ζ)²/6 of a slope is left by its third derivative, ζ > .003, and 1e-7 by the Jacobian's
    // own step of what rings; besides the rounding of a cost over a step.
    const double step = i < 12 && i % 2 == 0 ? 1e-6 : 1e-5;
    const double difference =
        (likelihood.at(moved(model, i, step)).cost - likelihood.at(moved(model, i, -step)).cost) /
        (2.0 * step);
    EXPECT_NEAR(slope[static_cast<Eigen::Index>(i)], difference,
                1e-5 * std::abs(difference) + 1e-12 * point.cost / step)
        << i;
  }
  // The cost does not see what a column has along PX or h; the information does.
  const double rounding = 1e-10 * jacobian.norm();
  if (!GetParam()) {
    EXPECT_LT((point.span.basis().transpose() * jacobian).norm(), rounding);
  }
  const auto length = static_cast<Eigen::Index>(point.bins.padded());
  for (Eigen::Index i = 0; i < jacobian.cols(); ++i) {
    for (std::size_t m = 0; m < point.told.size(); ++m) {
      const auto at = static_cast<Eigen::Index>(m);
      Complex along;
      for (Eigen::Index k = 0; k < 3; ++k) {
        const Complex part(jacobian(k * length + at, i), jacobian((3 + k) * length + at, i));
        along += std::conj(point.bins.sensors[static_cast<std::size_t>(k)].weighted.at(m)) * part;
      }
      ASSERT_LT(std::abs(along) / std::sqrt(point.told[m]), rounding) << i << ' ' << m;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, BlindLikelihoodAtRest, testing::Bool());

}  // namespace
}  // namespace modcal::blind_likelihood_test
