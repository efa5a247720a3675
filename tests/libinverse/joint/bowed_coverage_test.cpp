// The 95 % band on the force of a bowed string, which is no draw of a Gaussian process.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "libinverse/joint/joint_estimators.hpp"
#include "libsim/base/random.hpp"
#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::bowed_coverage_test {
namespace {

constexpr double kRate = 51200.0;
constexpr std::size_t kSamples = 51200;

struct BowedString {
  BowedString() : run(simulate()), basis(make_modal_basis(paper_scene().string)) {}
  static Simulation simulate() {
    Scene scene = paper_scene();
    scene.duration = 1.0;
    return ModalEvent(ModalEvent::Options{}).simulate(scene, kRate, OutputRequest::all());
  }
  static std::span<const double> of(const Signal& signal) {
    return std::span(signal.samples).first(kSamples);
  }
  std::vector<double> measured(const Signal& signal, double level, const StreamKey& key) const {
    std::vector<double> samples(of(signal).begin(), of(signal).end());
    const double rms = level * standard_deviation(samples);
    std::vector<double> noise(kSamples);
    fill_standard_normal(key, noise);
    for (std::size_t j = 0; j < kSamples; ++j) samples[j] += rms * noise[j];
    remove_mean(samples);
    return samples;
  }
  Simulation run;
  ModalBasis basis;
};

const BowedString& bowed_string() {
  static const BowedString string;
  return string;
}

// Share of 0.1 s to 0.95 s where |x − truth| ≤ 1.96 deviations, means taken out: sensors give none.
double share_held(std::span<const double> identified, std::span<const double> truth,
                  double deviation) {
  const auto begin = static_cast<std::size_t>(0.1 * kRate);
  const auto end = static_cast<std::size_t>(0.95 * kRate);
  double offset = 0.0, held = 0.0;
  for (std::size_t j = begin; j < end; ++j) offset += identified[j] - truth[j];
  offset /= static_cast<double>(end - begin);
  for (std::size_t j = begin; j < end; ++j) {
    if (std::abs(identified[j] - truth[j] - offset) <= 1.959964 * deviation) held += 1.0;
  }
  return held / static_cast<double>(end - begin);
}

std::array<double, 3> coverage(double level, std::uint64_t draws) {
  const BowedString& string = bowed_string();
  const auto prepared =
      JointEstimator(JointEstimator::Options{})
          .prepare({string.basis, paper_scene().bow.position, kSamples, kRate, false});
  const auto regularizer = Choice<Regularizer>("none").make();
  const auto rule = Choice<ParameterChoice>("gcv").make();
  std::array<double, 3> held = {0.0, 0.0, 0.0};
  for (std::uint64_t draw = 0; draw < draws; ++draw) {
    const auto left = string.measured(string.run.left_reaction, level, StreamKey(draw).with("R1"));
    const auto right =
        string.measured(string.run.right_reaction, level, StreamKey(draw).with("R2"));
    EstimationRecord record;
    record.reactions = {left, right};
    const Estimate estimate =
        prepared
            ->estimate(
                record,
                {*regularizer, *rule, {.force = true, .displacement = true, .velocity = true}})
            .front();
    held[0] +=
        share_held(estimate.result.force, string.of(string.run.force), estimate.force_deviation);
    held[1] += share_held(estimate.result.velocity, string.of(string.run.velocity),
                          estimate.velocity_deviation);
    held[2] += share_held(estimate.result.displacement, string.of(string.run.displacement),
                          estimate.displacement_deviation);
  }
  for (double& share : held) share /= static_cast<double>(draws);
  return held;
}

class Coverage : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Noise, Coverage, testing::Values(0.01, 0.02, 0.05, 0.1));

TEST_P(Coverage, HoldsNinetyFivePercentOfABowedForce) {
  // 200 draws over the four levels.
  for (const double share : coverage(GetParam(), 50)) {
    EXPECT_GE(share, 0.93);
    EXPECT_LE(share, 0.97);
  }
}

TEST(CoverageWithoutNoise, IsKeptByTheMisfitOfTheSides) {
  // The noise level alone, 1e-6 N, would hold 0.75, 0.09 and 0.88: aliases and the wrapped end
  // remain. Where the misfit stands in for noise the band may be wider than it needs to be.
  for (const double level : {0.0, 1e-4}) {
    for (const double share : coverage(level, 1)) EXPECT_GE(share, 0.93) << level;
  }
}

}  // namespace
}  // namespace modcal::bowed_coverage_test
