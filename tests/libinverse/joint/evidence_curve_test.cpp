#include "libinverse/joint/evidence_curve.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"

namespace modcal::evidence_curve_test {
namespace {

struct Components {
  explicit Components(std::size_t count) : g(count), power(count), solution(count) {
    std::vector<double> draw(2 * count);
    fill_standard_normal(StreamKey(4), draw);
    for (std::size_t i = 0; i < count; ++i) {
      g[i] = std::pow(10.0, 2.0 * draw[2 * i]);
      power[i] = 2.0 * (1.0 + g[i] / 0.01) * draw[2 * i + 1] * draw[2 * i + 1];  // prior at λ = 0.1
      solution[i] = power[i] / g[i];
    }
  }
  // The same by one sum over all components.
  CurvePoint at(double parameter) const {
    CurvePoint point;
    double residual = 0.0, solved = 0.0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      const double ratio = g[i] / (parameter * parameter), kept = ratio / (1.0 + ratio);
      point.criterion += 2.0 * std::log1p(ratio) - power[i] * kept;
      point.freedom += 2.0 * kept;
      residual += power[i] / ((1.0 + ratio) * (1.0 + ratio));
      solved += kept * kept * solution[i];
    }
    point.residual_norm = std::sqrt(residual);
    point.solution_norm = std::sqrt(solved);
    return point;
  }
  std::vector<double> g, power, solution;
};

TEST(EvidenceCurve, IsTheSumOverAllComponents) {
  const Components components(1003);  // not a multiple of any block
  EvidenceCurve::Cells cells;
  cells.clear();
  cells.add_pairs(components.g, components.power, components.solution);
  ChosenParameter choice;
  EvidenceCurve(100).trace(cells, choice);
  ASSERT_EQ(choice.curve.size(), 100u);
  EXPECT_EQ(cells.freedom, 2006.0);
  for (const CurvePoint& point : choice.curve) {
    if (point.parameter < 1e-6 || point.parameter > 1e3) continue;
    const CurvePoint expected = components.at(point.parameter);
    // Linear interpolation over a cell of h = ln 2/16: h²/8 = 2.3e-4 of a second derivative in log
    // g, which is at most four times a term of a squared norm (g² where all is lost or kept), twice
    // of a norm, and once a share or a logarithm.
    EXPECT_NEAR(point.residual_norm, expected.residual_norm, 5e-4 * expected.residual_norm);
    EXPECT_NEAR(point.solution_norm, expected.solution_norm, 5e-4 * expected.solution_norm);
    EXPECT_NEAR(point.freedom, expected.freedom, 2.4e-4 * expected.freedom);
    EXPECT_NEAR(point.criterion, expected.criterion,
                3e-4 * (std::abs(expected.criterion) + 2006.0));
  }
  EXPECT_EQ(choice.status, ChoiceStatus::kChosen);
  // 1003 pairs tell an amplitude to 1/√1003 of λ² or so.
  EXPECT_NEAR(choice.parameter(), 0.1, 0.01);
}

TEST(EvidenceCurve, OneComponentAtATimeIsTheSame) {
  const Components components(77);
  EvidenceCurve::Cells together, apart;
  together.clear();
  apart.clear();
  together.add_pairs(components.g, components.power, components.solution);
  for (std::size_t i = 0; i < components.g.size(); ++i) {
    apart.add(components.g[i], 2.0, components.power[i], components.solution[i]);
  }
  ChosenParameter first, second;
  EvidenceCurve(100).trace(together, first);
  EvidenceCurve(100).trace(apart, second);
  // log₂ g is 2e-5 near in the kernel.
  EXPECT_NEAR(first.parameter(), second.parameter(), 1e-4 * second.parameter());
}

TEST(EvidenceCurve, WhatIsNotSeenIsResidual) {
  EvidenceCurve::Cells cells;
  cells.clear();
  const std::vector<double> g = {0.0, 0.0}, power = {4.0, 5.0}, solution = {0.0, 0.0};
  cells.add_pairs(g, power, solution);
  ChosenParameter choice;
  EvidenceCurve(100).trace(cells, choice);
  EXPECT_EQ(choice.curve[50].residual_norm, 3.0);
  EXPECT_EQ(choice.curve[50].freedom, 0.0);
  EXPECT_THROW(EvidenceCurve(2), InvalidInput);
}

}  // namespace
}  // namespace modcal::evidence_curve_test
