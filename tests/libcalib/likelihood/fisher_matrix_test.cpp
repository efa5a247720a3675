// The information of the joint likelihood against that of the records themselves, sample by sample.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "libcalib/likelihood/projected_likelihood.hpp"
#include "libcalib/parameters/string_unknowns.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal::fisher_matrix_test {
namespace {

using Index = Eigen::Index;
constexpr double kRate = 51200.0;
constexpr Index kSamples = 2048;

// A mode under a force that is linear between samples: z' = λz + f, R_r = Σ_n Im(gain_rn z_n).
struct TimeMode {
  Complex step, old_force, new_force;
  double gain[2];
};

std::vector<TimeMode> time_modes(const ModelPoint& point) {
  const double dt = 1.0 / kRate;
  const ModalBasis& basis = point.basis;
  const std::vector<double> shape = basis.shape_at(point.contact);
  std::vector<TimeMode> modes;
  for (std::size_t i = 0; i < basis.size(); ++i) {
    const double turn = basis.omega[i] * std::sqrt(1.0 - basis.zeta[i] * basis.zeta[i]);
    const Complex rate(-basis.zeta[i] * basis.omega[i], turn);
    const Complex step = std::exp(rate * dt);
    const Complex ramp = (step - 1.0 - rate * dt) / (rate * rate * dt);
    const double n = static_cast<double>(i + 1);
    const double gain =
        basis.tension * n * std::numbers::pi / basis.length * shape[i] / (basis.mass[i] * turn);
    modes.push_back({step, (step - 1.0) / rate - ramp, ramp, {-gain, i % 2 == 1 ? gain : -gain}});
  }
  return modes;
}

// Both reactions, one below the other, each over its noise.
Eigen::VectorXd respond(const ModelPoint& point, std::span<const double> force,
                        const std::array<double, 2>& deviation) {
  Eigen::VectorXd reactions = Eigen::VectorXd::Zero(2 * kSamples);
  for (const TimeMode& mode : time_modes(point)) {
    Complex z = 0.0;
    double before = 0.0;
    for (Index k = 0; k < kSamples; ++k) {
      const double now = force[static_cast<std::size_t>(k)];
      z = mode.step * z + mode.old_force * before + mode.new_force * now;
      before = now;
      for (Index r = 0; r < 2; ++r) {
        reactions[r * kSamples + k] +=
            mode.gain[r] * z.imag() / deviation[static_cast<std::size_t>(r)];
      }
    }
  }
  return reactions;
}

// Free decays of all modes from any state, and an offset of each record.
Eigen::MatrixXd free_columns(const ModelPoint& point, const std::array<double, 2>& deviation) {
  const std::vector<TimeMode> modes = time_modes(point);
  const auto count = static_cast<Index>(modes.size());
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(2 * kSamples, 2 * count + 2);
  for (Index n = 0; n < count; ++n) {
    const TimeMode& mode = modes[static_cast<std::size_t>(n)];
    // The gain may vanish at a node; the state's own column must not.
    const double sign = mode.gain[0] * mode.gain[1] > 0.0 ? 1.0 : -1.0;
    Complex z = 1.0;
    for (Index k = 0; k < kSamples; ++k, z *= mode.step) {
      for (Index r = 0; r < 2; ++r) {
        const double scale = (r == 1 ? sign : 1.0) / deviation[static_cast<std::size_t>(r)];
        columns(r * kSamples + k, 2 * n) = scale * z.real();
        columns(r * kSamples + k, 2 * n + 1) = scale * z.imag();
      }
    }
  }
  for (Index r = 0; r < 2; ++r) {
    columns.col(2 * count + r).segment(r * kSamples, kSamples).setConstant(1.0);
  }
  columns.colwise().normalize();
  return columns;
}

// Σ_r G_rᵀG_r and Σ_r G_rᵀX_r with the Toeplitz matrices G_r of the responses to one sample of
// force: every sample of the force is an unknown.
struct ForceNormal {
  Eigen::MatrixXd own, mixed;
};
ForceNormal force_normal(const Eigen::VectorXd& response, const Eigen::MatrixXd& columns) {
  ForceNormal normal{Eigen::MatrixXd::Zero(kSamples, kSamples),
                     Eigen::MatrixXd::Zero(kSamples, columns.cols())};
  for (Index r = 0; r < 2; ++r) {
    const auto g = response.segment(r * kSamples, kSamples);
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(kSamples + 1, kSamples + 1);
    for (Index j = kSamples - 1; j >= 0; --j) {
      for (Index i = kSamples - 1; i >= j; --i) {
        products(i, j) = products(i + 1, j + 1) + g[kSamples - 1 - i] * g[kSamples - 1 - j];
      }
    }
    normal.own += products.topLeftCorner(kSamples, kSamples);
    for (Index j = 0; j < kSamples; ++j) {
      normal.mixed.row(j) +=
          g.head(kSamples - j).transpose() * columns.middleRows(r * kSamples + j, kSamples - j);
    }
  }
  return normal;
}

ModelPoint law_point(ModelPoint point, double fundamental, double inharmonicity) {
  for (std::size_t i = 0; i < point.basis.size(); ++i) {
    const double n = static_cast<double>(i + 1);
    point.basis.omega[i] =
        2.0 * std::numbers::pi * n * fundamental * std::sqrt(1.0 + inharmonicity * n * n);
  }
  return point;
}

// The paper's string with stiffness, 40 ms, at rest before.
struct FisherCase {
  ModelPoint truth;
  std::vector<double> force;
  NoisyRecords records{.sample_rate = kRate};
  Eigen::VectorXd clean;  ///< both reactions over their noise, means in them
};

FisherCase fisher_case() {
  Scene scene = paper_scene();
  scene.bow.position = 0.0285;
  scene.string.inharmonicity = 1.39e-4;
  scene.duration = static_cast<double>(kSamples) / kRate;
  const Simulation run = ModalEvent({}).simulate(scene, kRate, {.force = true});
  FisherCase result{.truth = {make_modal_basis(scene.string), 0.0285}, .force = run.force.samples};
  result.force.resize(kSamples);
  const std::array<double, 2> one{1.0, 1.0};
  result.clean = respond(result.truth, result.force, one);
  for (std::size_t r = 0; r < 2; ++r) {
    auto part = result.clean.segment(static_cast<Index>(r) * kSamples, kSamples);
    result.records.reactions[r].assign(part.begin(), part.end());
    remove_mean(result.records.reactions[r]);
    result.records.deviation[r] = 0.01 * standard_deviation(result.records.reactions[r]);
    part /= result.records.deviation[r];
  }
  return result;
}

// Columns of ln f0, B, x_c and ln ζ, by central differences.
Eigen::MatrixXd string_slopes(const FisherCase& the) {
  const double steps[] = {1e-6, 1e-8, 1e-7, 1e-4};
  const auto at = [&](int parameter, double step) {
    ModelPoint point = law_point(the.truth, 196.0 * std::exp(parameter == 0 ? step : 0.0),
                                 1.39e-4 + (parameter == 1 ? step : 0.0));
    if (parameter == 2) point.contact += step;
    if (parameter == 3) {
      for (double& zeta : point.basis.zeta) zeta *= std::exp(step);
    }
    return respond(point, the.force, the.records.deviation);
  };
  Eigen::MatrixXd slopes(2 * kSamples, 4);
  for (int i = 0; i < 4; ++i) {
    slopes.col(i) = (at(i, steps[i]) - at(i, -steps[i])) / (2.0 * steps[i]);
  }
  return slopes;
}

// Covariance of what `slopes` belong to, every sample of the force and what `nuisance` belongs to
// being free.
Eigen::MatrixXd time_domain_covariance(const FisherCase& the, const Eigen::MatrixXd& slopes,
                                       const Eigen::MatrixXd& nuisance) {
  const Eigen::VectorXd norms = slopes.colwise().norm();
  const Index count = slopes.cols();
  Eigen::MatrixXd columns(2 * kSamples, nuisance.cols() + count);
  columns << nuisance, slopes * norms.cwiseInverse().asDiagonal();
  // A unit of force at one sample is a triangle, which begins a sample earlier.
  std::vector<double> unit(static_cast<std::size_t>(kSamples), 0.0);
  unit[0] = 1.0;
  const ForceNormal normal = force_normal(respond(the.truth, unit, the.records.deviation), columns);
  const Eigen::LLT<Eigen::MatrixXd> factor(normal.own);
  EXPECT_EQ(factor.info(), Eigen::Success);
  const Eigen::MatrixXd half = factor.matrixL().solve(normal.mixed);
  Eigen::MatrixXd rest = columns.transpose() * columns - half.transpose() * half;
  const Index other = nuisance.cols();
  Eigen::MatrixXd state = rest.topLeftCorner(other, other);
  state.diagonal().array() += 1e-13;
  const Eigen::MatrixXd cross = rest.topRightCorner(other, count);
  const Eigen::MatrixXd direct =
      rest.bottomRightCorner(count, count) - cross.transpose() * state.ldlt().solve(cross);
  return norms.cwiseInverse().asDiagonal() * direct.inverse() * norms.cwiseInverse().asDiagonal();
}

Eigen::MatrixXd likelihood_covariance(const FisherCase& the, const UnknownsOptions& unknowns) {
  WhitenedRecord record = WhitenedRecord::of(the.records, 0.0, 0.98 * std::numbers::pi * kRate);
  record.energy *= 10.0;  // so large an end state as to be free: its prior tells 1e-4
  const ProjectedLikelihood likelihood(record);
  ModelPoint point = the.truth;
  point.sensors = unknowns.sensors();
  const StringUnknowns law = StringUnknowns::law(point, 196.0, 1.39e-4, unknowns);
  return (2.0 * likelihood.evaluate(point, law.columns(law.start())).information).inverse();
}

TEST(FisherMatrix, IsThatOfTheSamplesWithForceAndInitialStateFree) {
  const FisherCase the = fisher_case();
  const Eigen::MatrixXd expected = time_domain_covariance(
      the, string_slopes(the), free_columns(the.truth, the.records.deviation));
  const Eigen::MatrixXd found = likelihood_covariance(the, {});
  for (Index i = 0; i < 4; ++i) {
    // What separates the two is how the force runs between the samples.
    EXPECT_NEAR(std::sqrt(found(i, i) / expected(i, i)), 1.0, 1e-3) << "parameter " << i;
  }
}

TEST(FisherMatrix, KnowsTheCornerOfASensorAsFarAsTheMeanIsNotMeasured) {
  // Gain and corner of the sensor at x = L, at equal sensors: ∂R₂ = R₂ ∂ln g − ∂ω_h ∫R₂ dt. The
  // mean of R₂ is not measured, so that the integral holds a ramp of any slope.
  const FisherCase the = fisher_case();
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(2 * kSamples, 6);
  slopes.leftCols(4) = string_slopes(the);
  const Eigen::MatrixXd known = free_columns(the.truth, the.records.deviation);
  Eigen::MatrixXd nuisance = Eigen::MatrixXd::Zero(2 * kSamples, known.cols() + 2);
  nuisance.leftCols(known.cols()) = known;
  double integral = 0.0, before = 0.0;
  for (Index k = 0; k < kSamples; ++k) {
    const double now = the.clean[kSamples + k];
    integral += 0.5 * (before + now) / kRate;
    before = now;
    slopes(kSamples + k, 4) = now;
    slopes(kSamples + k, 5) = -integral;
    nuisance(kSamples + k, known.cols()) = static_cast<double>(k) / static_cast<double>(kSamples);
  }
  nuisance(kSamples, known.cols() + 1) = 1.0;  // a sample that the delay would bring in
  nuisance.rightCols(2).colwise().normalize();
  UnknownsOptions unknowns;
  unknowns.sensor[Sensor::kGain].free = unknowns.sensor[Sensor::kCorner].free = true;
  const Eigen::MatrixXd expected = time_domain_covariance(the, slopes, nuisance);
  const Eigen::MatrixXd found = likelihood_covariance(the, unknowns);
  for (Index i = 0; i < 6; ++i) {
    EXPECT_NEAR(std::sqrt(found(i, i) / expected(i, i)), 1.0, 1e-3) << "parameter " << i;
  }
  // Whoever knew the mean would know the corner by far better from a record this short.
  Eigen::MatrixXd without(2 * kSamples, known.cols() + 1);
  without << known, nuisance.rightCols(1);
  const Eigen::MatrixXd wrong = time_domain_covariance(the, slopes, without);
  EXPECT_LT(std::sqrt(wrong(5, 5)), 0.9 * std::sqrt(found(5, 5)));
}

}  // namespace
}  // namespace modcal::fisher_matrix_test
