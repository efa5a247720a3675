#include "libcalib/likelihood/pluck/pluck_likelihood.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "libcalib/optimizers/staged/newton_fit.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/likelihood/pluck_record_case.hpp"

namespace modcal::pluck_likelihood_test {
namespace {

using std::numbers::pi;

constexpr double kBand = 2.0 * pi * 10300.0;

ModelPoint paper_point(double inharmonicity, std::int64_t modes = 50) {
  Scene scene = paper_scene();
  scene.string.inharmonicity = inharmonicity;
  scene.string.modes = modes;
  return {make_modal_basis(scene.string), 0.03};
}

UnknownsOptions all_free(const std::string& damping) {
  UnknownsOptions options;
  options.damping = damping;
  options.sensor[Sensor::kGain].free = options.sensor[Sensor::kDelay].free =
      options.sensor[Sensor::kCorner].free = true;
  return options;
}

TEST(PluckLikelihood, IsNoiseAtTheTruth) {
  for (const double b : {0.0, 1.39e-4}) {
    const PluckLikelihood pluck(WhitenedRecord::of(plucked_records(b, 0.5, 3e-3, 4), 0.0, kBand));
    const ModelPoint truth = paper_point(b);
    const double freedom = pluck.degrees_of_freedom(truth);
    EXPECT_NEAR(2.0 * pluck.cost(truth) / freedom, 1.0, 5.0 * std::sqrt(2.0 / freedom));
    // Without noise nothing is left of a signal 330 times the noise.
    const PluckLikelihood clean(WhitenedRecord::of(plucked_records(b, 0.5, 3e-3, 0), 0.0, kBand));
    EXPECT_LT(clean.cost(truth) / freedom, 1e-4);
    ModelPoint off = truth;
    off.basis.omega[10] *= 1.0005;
    EXPECT_GT(pluck.cost(off), 1.02 * pluck.cost(truth));
  }
}

// Of a D(z) and b D(z) it explains all, (|a|² + |b|²) Σ |D|² over the 256 bins about it.
TEST(PluckLikelihood, ExplainsThePowerOfADecayAtBothEnds) {
  WhitenedRecord record =
      WhitenedRecord::of(plucked_records(1.39e-4, 0.1, 0.02, 3, 12), 0.0, 2.0 * pi * 8000.0);
  const double omega = 2.0 * pi * 4000.0;
  const Complex pole = std::exp(Complex(-20.0, omega) / record.sample_rate);
  const Complex a(0.6, -0.3), b(1.0, 2.0);
  const auto center = static_cast<std::size_t>(omega / record.spacing);
  double power = 0.0;
  for (std::size_t k = 0; k < record.bins; ++k) {
    const Complex decay = 1.0 / (1.0 - pole * record.delay.at(k));
    record.left.set(k, a * decay);
    record.right.set(k, b * decay);
    if (k + 128 >= center && k < center + 128) power += std::norm(decay);
  }
  ASSERT_GT(center, 128u);
  const double explained = PluckLikelihood(record).power_about(pole, omega);
  EXPECT_NEAR(explained / ((std::norm(a) + std::norm(b)) * power), 1.0, 1e-12);
}

TEST(PluckLikelihood, GradientOfEveryUnknownIsTheDifferenceQuotient) {
  const PluckLikelihood pluck(
      WhitenedRecord::of(plucked_records(1.39e-4, 0.1, 0.02, 3, 12), 0.0, 2.0 * pi * 3000.0));
  ModelPoint off = paper_point(1.39e-4, 12);
  off.sensors = {.gain = 1.01, .delay = 1e-6, .corner = 2.0 * pi * 3.0};
  for (double& omega : off.basis.omega) omega *= 1.0 + 5e-5;
  for (const std::string damping : {"power", "each"}) {
    for (const bool law : {false, true}) {
      const StringUnknowns unknowns =
          law ? StringUnknowns::law(off, 196.0, 1.39e-4, all_free(damping))
              : StringUnknowns::frequencies(off, all_free(damping));
      const Eigen::VectorXd start = unknowns.start();
      const LikelihoodPoint at = pluck.evaluate(unknowns.model(start), unknowns.columns(start));
      EXPECT_NEAR(at.cost, pluck.cost(unknowns.model(start)), 1e-9 * at.cost);
      for (Eigen::Index i = 0; i < unknowns.size(); ++i) {
        if (i == unknowns.contact()) {
          EXPECT_EQ(at.slope[i], 0.0);
          EXPECT_EQ(at.information(i, i), 0.0);
          continue;
        }
        // A hundredth of a standard deviation, all else known, or less.
        const double size = std::sqrt(at.information(i, i));
        const double step = std::min(1e-2 / size, 1e-3);
        Eigen::VectorXd above = start, below = start;
        above[i] += step;
        below[i] -= step;
        const double quotient =
            (pluck.cost(unknowns.model(above)) - pluck.cost(unknowns.model(below))) / (2.0 * step);
        EXPECT_NEAR(2.0 * at.slope[i], quotient, 2e-3 * size * std::sqrt(at.cost))
            << damping << ", unknown " << i;
      }
    }
  }
}

// Fisher matrix of (ln ω_n, ln ζ_n) from samples: y_r = Σ ±Re(A_n exp(λ_n t)) + noise, A_n and one
// constant an end unknown.
Eigen::MatrixXd information_in_time(const ModelPoint& truth, const NoisyRecords& records) {
  const auto modes = static_cast<Eigen::Index>(truth.basis.size());
  const auto count = static_cast<Eigen::Index>(records.samples());
  Eigen::MatrixXd linear = Eigen::MatrixXd::Zero(2 * count, 2 * modes + 2);
  Eigen::MatrixXcd decays(count, modes);
  Eigen::VectorXd data(2 * count);
  for (Eigen::Index r = 0; r < 2; ++r) {
    const double weight = 1.0 / records.deviation[static_cast<std::size_t>(r)];
    for (Eigen::Index j = 0; j < count; ++j) {
      const double t = static_cast<double>(j) / records.sample_rate;
      data[r * count + j] =
          weight * records.reactions[static_cast<std::size_t>(r)][static_cast<std::size_t>(j)];
      linear(r * count + j, 2 * modes + r) = weight;
      for (Eigen::Index n = 0; n < modes; ++n) {
        const double omega = truth.basis.omega[static_cast<std::size_t>(n)];
        const double zeta = truth.basis.zeta[static_cast<std::size_t>(n)];
        decays(j, n) =
            std::exp(std::complex<double>(-zeta * omega, omega * std::sqrt(1.0 - zeta * zeta)) * t);
        const double sign = r == 1 && n % 2 == 1 ? -weight : weight;
        linear(r * count + j, 2 * n) = sign * decays(j, n).real();
        linear(r * count + j, 2 * n + 1) = -sign * decays(j, n).imag();
      }
    }
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(linear);
  const Eigen::VectorXd found = qr.solve(data);
  Eigen::MatrixXd slopes(2 * count, 2 * modes);
  for (Eigen::Index n = 0; n < modes; ++n) {
    const double omega = truth.basis.omega[static_cast<std::size_t>(n)];
    const double zeta = truth.basis.zeta[static_cast<std::size_t>(n)];
    const double root = std::sqrt(1.0 - zeta * zeta);
    const std::complex<double> amplitude(found[2 * n], found[2 * n + 1]);
    const std::complex<double> by[2] = {{-zeta * omega, omega * root},
                                        {-zeta * omega, -omega * zeta * zeta / root}};
    for (Eigen::Index r = 0; r < 2; ++r) {
      const double weight =
          (r == 1 && n % 2 == 1 ? -1.0 : 1.0) / records.deviation[static_cast<std::size_t>(r)];
      for (Eigen::Index j = 0; j < count; ++j) {
        const double t = static_cast<double>(j) / records.sample_rate;
        for (Eigen::Index i = 0; i < 2; ++i) {
          slopes(r * count + j, n + i * modes) =
              weight * (amplitude * decays(j, n) * by[i] * t).real();
        }
      }
    }
  }
  const Eigen::MatrixXd thin =
      qr.householderQ() * Eigen::MatrixXd::Identity(linear.rows(), linear.cols());
  slopes -= thin * (thin.transpose() * slopes);
  return slopes.transpose() * slopes;
}

TEST(PluckLikelihood, HasTheInformationOfTheSamples) {
  const NoisyRecords records = plucked_records(1.39e-4, 0.08, 0.01, 0, 6);
  const ModelPoint truth = paper_point(1.39e-4, 6);
  UnknownsOptions each;
  each.damping = "each";
  const StringUnknowns unknowns = StringUnknowns::frequencies(truth, each);
  const PluckLikelihood pluck(WhitenedRecord::of(records, 0.0, pi * 51200.0));
  const Eigen::MatrixXd information =
      2.0 * pluck.evaluate(truth, unknowns.columns(unknowns.start())).information;
  const Eigen::MatrixXd expected = information_in_time(truth, records);
  // f_n first, then x_c, then ζ_n. Two bins in a hundred are left out, at the top of the band.
  for (Eigen::Index i = 0; i < 12; ++i) {
    for (Eigen::Index j = 0; j < 12; ++j) {
      const double scale = std::sqrt(expected(i, i) * expected(j, j));
      const double found = information(i + i / 6, j + j / 6);
      EXPECT_NEAR(found / scale, expected(i, j) / scale, 2e-3) << i << ", " << j;
    }
  }
}

TEST(PluckLikelihood, FindsLawAndDamping) {
  const NoisyRecords records = plucked_records(1.39e-4, 0.5, 0.01, 9);
  const PluckLikelihood pluck(WhitenedRecord::of(records, 0.0, kBand));
  ModelPoint start = paper_point(1.39e-4);
  for (double& zeta : start.basis.zeta) zeta *= 1.1;
  const StringUnknowns unknowns = StringUnknowns::law(start, 196.01, 1.391e-4);
  Eigen::VectorXd held = Eigen::VectorXd::Zero(4);
  held[unknowns.contact()] = 1.0;  // the pluck knows nothing of it
  const NewtonFit fit =
      newton_fit({.evaluate =
                      [&](const Eigen::VectorXd& theta) {
                        return pluck.evaluate(unknowns.model(theta), unknowns.columns(theta));
                      },
                  .admits = [&](const Eigen::VectorXd& theta) { return unknowns.admits(theta); }},
                 unknowns.start(), {.prior = held.asDiagonal()});
  EXPECT_TRUE(fit.converged);
  const Eigen::MatrixXd hessian = 2.0 * fit.point.information + Eigen::MatrixXd(held.asDiagonal());
  const Eigen::VectorXd sd = hessian.inverse().diagonal().cwiseSqrt();
  EXPECT_LT(std::abs(unknowns.fundamental(fit.theta) / 196.0 - 1.0), 6.0 * sd[0]);
  EXPECT_LT(std::abs(fit.theta[1] - 1.39e-4), 6.0 * sd[1]);
  EXPECT_LT(std::abs(fit.theta[3] - std::log(1.0 / 1.1)), 6.0 * sd[3]);
}

TEST(PluckLikelihood, RefusesADampedRecord) {
  const NoisyRecords records = plucked_records(0.0, 0.05, 0.01, 0, 6);
  EXPECT_THROW(PluckLikelihood(WhitenedRecord::of(records, 20.0, kBand)), InvalidInput);
}

}  // namespace
}  // namespace modcal::pluck_likelihood_test
