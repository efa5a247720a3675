// The posterior of a periodic record by dense matrices: records of odd and even length, with the
// static level known or not. The first bin and the last of an even length are one degree of
// freedom there, as no list of bins says.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "tests/libinverse/joint/joint_case.hpp"

namespace modcal::posterior_oracle_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// x ↦ inverse FFT of H times the FFT of x, as far as samples show it.
MatrixXd circulant(std::vector<Complex> spectrum, std::size_t samples) {
  spectrum.front() = spectrum.front().real();
  if (samples % 2 == 0) spectrum.back() = spectrum.back().real();
  const std::vector<double> column = RealFft(samples).inverse(std::move(spectrum));
  const auto size = static_cast<Eigen::Index>(samples);
  MatrixXd matrix(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) {
      matrix(i, j) = column[static_cast<std::size_t>((i - j + size) % size)];
    }
  }
  return matrix;
}

VectorXd vector_of(std::span<const double> values) {
  return Eigen::Map<const VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

class PosteriorOracle : public testing::TestWithParam<std::tuple<std::size_t, OffsetRule>> {
 protected:
  std::size_t samples() const { return std::get<0>(GetParam()); }
  bool level_known() const { return std::get<1>(GetParam()) == OffsetRule::kArrival; }

  void SetUp() override {
    const ModalBasis basis = violin_g();
    const FrequencyGrid grid = FrequencyGrid::of_record(samples(), kRate);
    const StringTransfer transfer = string_transfer(basis, kPosition, grid, {}, {});
    std::vector<Complex> mobility = transfer.receptance, prior;
    for (std::size_t k = 0; k < grid.bins; ++k) {
      mobility[k] *= Complex{0.0, grid.omega(k)};
      variance_.push_back(0.4 + 0.3 * std::cos(0.9 * static_cast<double>(k)));
      prior.emplace_back(variance_.back());
    }
    const auto size = static_cast<Eigen::Index>(samples());
    MatrixXd shown = MatrixXd::Identity(size, size);
    if (!level_known()) shown.array() -= 1.0 / static_cast<double>(size);
    prior_ = shown * circulant(prior, samples()) * shown;
    receptance_ = circulant(transfer.receptance, samples());
    mobility_ = circulant(mobility, samples());
    const JointInversion inversion(basis, kPosition, samples(), kRate,
                                   {.truncation = Truncation::kWrapped});
    std::vector<double> reaction[2];
    const auto force = vector_of(normal_draw(samples(), StreamKey(11)));
    response_.resize(2 * size, size);  // over the noise, as the data
    data_.resize(2 * size);
    for (std::size_t r = 0; r < 2; ++r) {
      const MatrixXd h = circulant(transfer.reaction[r], samples());
      const VectorXd recorded =
          h * force + kNoise[r] * vector_of(normal_draw(samples(), StreamKey(12 + r)));
      reaction[r].assign(recorded.begin(), recorded.end());
      response_.middleRows(static_cast<Eigen::Index>(r) * size, size) = shown * h / kNoise[r];
      data_.segment(static_cast<Eigen::Index>(r) * size, size) = recorded;
    }
    JointMethod method = method_with(kJumps, kEverything);
    method.offset = std::get<1>(GetParam());
    method.known_variance = variance_;
    result_ = invert(inversion, {reaction[0], reaction[1]}, {.rms = kNoise}, method);
    for (std::size_t r = 0; r < 2; ++r) {
      auto part = data_.segment(static_cast<Eigen::Index>(r) * size, size);
      part = shown * ((part.array() - result_.offset[r]) / kNoise[r]).matrix();
    }
  }

  /// Gain of the data on the force, for a prior of this amplitude.
  MatrixXd gain(double amplitude) const {
    const MatrixXd spread = amplitude * prior_ * response_.transpose();
    return evidence(amplitude).ldlt().solve(spread.transpose()).transpose();
  }
  /// Covariance of the data over that of their noise.
  MatrixXd evidence(double amplitude) const {
    const auto size = data_.size();
    return amplitude * response_ * prior_ * response_.transpose() + MatrixXd::Identity(size, size);
  }
  double freedom() const { return static_cast<double>(samples() - (level_known() ? 0 : 1)); }

  static constexpr std::array<double, 2> kNoise = {0.5, 0.3};
  std::vector<double> variance_;
  MatrixXd prior_, response_, receptance_, mobility_;
  VectorXd data_;
  JointResult result_;
};

INSTANTIATE_TEST_SUITE_P(Lengths, PosteriorOracle,
                         testing::Combine(testing::Values(1, 2, 3, 4, 7, 24, 25),
                                          testing::Values(OffsetRule::kArrival,
                                                          OffsetRule::kNone)));

// The responses of these strings stay below 100 and the noise above 0.3: a condition below 1e5 of
// matrices of 50 rows, whose solutions round to 50 · 1e5 · 1e-16.
constexpr double kRounding = 1e-9;

TEST_P(PosteriorOracle, SignalsAndTheirDeviationsAreThoseOfDenseMatrices) {
  const MatrixXd gain = this->gain(1.0);
  const MatrixXd covariance = prior_ - gain * response_ * prior_;
  const VectorXd force = gain * data_;
  const auto expect = [&](const MatrixXd& map, const std::vector<double>& signal,
                          double deviation) {
    const VectorXd expected = map * force;
    const double variance = (map * covariance * map.transpose())(0, 0);
    const double scale = map.norm();
    for (std::size_t j = 0; j < samples(); ++j) {
      EXPECT_NEAR(signal[j], expected[static_cast<Eigen::Index>(j)], kRounding * scale) << j;
    }
    EXPECT_NEAR(deviation * deviation, variance, kRounding * scale * scale);
  };
  const auto size = static_cast<Eigen::Index>(samples());
  expect(MatrixXd::Identity(size, size), result_.identified.force, result_.deviation.force);
  expect(receptance_, result_.identified.displacement, result_.deviation.displacement);
  expect(mobility_, result_.identified.velocity, result_.deviation.velocity);
}

TEST_P(PosteriorOracle, TheShareKeptIsThatOfTheDegreesOfFreedom) {
  const double kept = (gain(1.0) * response_).trace();
  const std::size_t unknown = level_known() ? 0 : 1;
  EXPECT_EQ(result_.identified.bins, samples() / 2 + 1 - unknown);
  EXPECT_EQ(result_.identified.blind_bins, 0u);
  const double share = freedom() > 0.0 ? kept / freedom() : 0.0;
  EXPECT_NEAR(result_.identified.choice.kept_share, share, kRounding);
}

// The amplitude's curve puts components in cells: 9e-4 of a sum of squares, half of it of a norm,
// a quarter of a share or a logarithm (EvidenceCurve).
TEST_P(PosteriorOracle, EvidenceAndFreedomOfEveryAmplitudeAreThoseOfDenseMatrices) {
  const double mean_noise = 0.5 * (kNoise[0] * kNoise[0] + kNoise[1] * kNoise[1]);
  std::size_t compared = 0;
  for (const CurvePoint& point : result_.identified.choice.curve) {
    if (point.parameter < 0.03 || point.parameter > 30.0) continue;
    const double amplitude = mean_noise / (point.parameter * point.parameter);
    const MatrixXd gain = this->gain(amplitude);
    const MatrixXd evidence = this->evidence(amplitude);
    const double kept = (gain * response_).trace();
    const double logarithm = std::log(evidence.determinant());
    const double power = data_.dot(data_ - evidence.ldlt().solve(data_));
    EXPECT_NEAR(point.freedom, kept, 2.4e-4 * kept + kRounding) << point.parameter;
    EXPECT_NEAR(point.criterion, logarithm - power, 3e-4 * (logarithm + power) + kRounding)
        << point.parameter;
    const double norm = (gain * data_).norm();
    EXPECT_NEAR(point.solution_norm, norm, 5e-4 * norm + kRounding) << point.parameter;
    ++compared;
  }
  EXPECT_GE(compared, 10u);
}

}  // namespace
}  // namespace modcal::posterior_oracle_test
