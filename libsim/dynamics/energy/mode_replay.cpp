#include "libsim/dynamics/energy/mode_replay.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libsim/dynamics/energy/mode_replay.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef MODCAL_MODE_REPLAY_TYPES
#define MODCAL_MODE_REPLAY_TYPES
namespace modcal {

// The most that ModeReplay::terms() asks for, at 4 radians, is 35.
inline constexpr std::size_t kMostReplayTerms = 64;

struct ReplayTask {
  const PlanarVector& pole;
  const AlignedVector &inverse_mass, &quadrature, &loss;
  const std::vector<AlignedVector>& shape;
  double time;
  std::size_t terms;
  std::span<const std::span<const double>> force;
  const GaussRule& rule;
};

}  // namespace modcal
#endif

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using ReplayTag = hn::CappedTag<double, kVectorPadding>;
using ReplayVec = hn::Vec<ReplayTag>;

// Weighted sum of the squares of Σ series[p] θ^p at kNodes points, side by side: a chain of
// multiply-adds each.
template <std::size_t kNodes>
HWY_INLINE ReplayVec Squares(const ReplayVec* series, std::size_t terms, const double* node,
                             const double* weight) {
  const ReplayTag d;
  ReplayVec value[kNodes];
  for (std::size_t g = 0; g < kNodes; ++g) value[g] = series[terms - 1];
  for (std::size_t p = terms - 1; p-- > 0;) {
    for (std::size_t g = 0; g < kNodes; ++g) {
      value[g] = hn::MulAdd(value[g], hn::Set(d, node[g]), series[p]);
    }
  }
  ReplayVec sum = hn::Zero(d);
  for (std::size_t g = 0; g < kNodes; ++g) {
    sum = hn::MulAdd(hn::Mul(value[g], value[g]), hn::Set(d, weight[g]), sum);
  }
  return sum;
}

// Powers of θ of one vector of modes from `re`, `im` on: of what the points see of them, without
// their shapes, in `series`; re and im move on to θ = 1.
HWY_INLINE void ReplaySeries(const ReplayTask& task, std::size_t i, const double* part,
                             const double (*push)[kMostReplayTerms], PlanarVector& state,
                             ReplayVec* series) {
  const ReplayTag d;
  const auto x = hn::Load(d, &task.pole.re[i]), y = hn::Load(d, &task.pole.im[i]);
  const auto mobility = hn::Load(d, &task.inverse_mass[i]), tilt = hn::Load(d, &task.quadrature[i]);
  auto re = hn::Load(d, &state.re[i]), im = hn::Load(d, &state.im[i]);
  auto end_re = hn::Zero(d), end_im = end_re;
  for (std::size_t p = 0; p < task.terms; ++p) {
    end_re = hn::Add(end_re, re);
    end_im = hn::Add(end_im, im);
    series[p] = hn::NegMulAdd(tilt, im, re);
    auto load = hn::Zero(d);
    for (std::size_t j = 0; j < task.force.size(); ++j) {
      load = hn::MulAdd(hn::Load(d, &task.shape[j][i]), hn::Set(d, push[j][p]), load);
    }
    const auto scale = hn::Set(d, part[p]);
    const auto a = hn::Mul(x, scale), b = hn::Mul(y, scale);
    const auto forced = hn::MulAdd(mobility, load, hn::Mul(a, re));
    const auto turned = hn::MulAdd(b, re, hn::Mul(a, im));
    re = hn::NegMulAdd(b, im, forced);
    im = turned;
  }
  hn::Store(end_re, d, &state.re[i]);
  hn::Store(end_im, d, &state.im[i]);
}

double ReplayModes(const ReplayTask& task, PlanarVector& state, PointPowers& velocity) {
  const ReplayTag d;
  const std::size_t points = task.force.size();
  const double* node = task.rule.node.data();
  const double* weight = task.rule.weight.data();
  double push[16][kMostReplayTerms] = {}, part[kMostReplayTerms];
  for (std::size_t p = 0; p < task.terms; ++p) {
    part[p] = task.time / static_cast<double>(p + 1);
    for (std::size_t j = 0; j < points; ++j) {
      if (p < task.force[j].size()) push[j][p] = task.force[j][p] * part[p];
      velocity[j][p] = 0.0;
    }
  }
  ReplayVec series[kMostReplayTerms], lost = hn::Zero(d);
  for (std::size_t i = 0; i < state.size(); i += hn::Lanes(d)) {
    ReplaySeries(task, i, part, push, state, series);
    for (std::size_t j = 0; j < points; ++j) {
      const auto shape = hn::Load(d, &task.shape[j][i]);
      for (std::size_t p = 0; p < task.terms; ++p) {
        velocity[j][p] += hn::GetLane(hn::SumOfLanes(d, hn::Mul(shape, series[p])));
      }
    }
    const auto square = task.rule.node.size() == 8 ? Squares<8>(series, task.terms, node, weight)
                                                   : Squares<14>(series, task.terms, node, weight);
    lost = hn::MulAdd(square, hn::Load(d, &task.loss[i]), lost);
  }
  return task.time * hn::GetLane(hn::SumOfLanes(d, lost));
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(ReplayModes);

GaussRule gauss_rule(int points) {
  GaussRule rule;
  for (int i = 0; i < points; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (points + 0.5)), slope = 1.0;
    for (int iteration = 0; iteration < 8; ++iteration) {
      double p = 1.0, before = 0.0;
      for (int k = 1; k <= points; ++k) {
        const double next = ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k;
        before = p;
        p = next;
      }
      slope = points * (x * p - before) / (x * x - 1.0);
      x -= p / slope;
    }
    rule.node.push_back(0.5 * (1.0 - x));
    rule.weight.push_back(1.0 / ((1.0 - x * x) * slope * slope));
  }
  return rule;
}

ModeReplay::ModeReplay(const ModeTable& modes, const std::vector<double>& inverse_mass)
    : modes_(modes.size()),
      pole_(modes_),
      state_(modes_),
      inverse_mass_(padded_size(modes_)),
      quadrature_(padded_size(modes_)),
      loss_(padded_size(modes_)),
      compliance_(modes.compliance),
      few_(gauss_rule(8)),
      many_(gauss_rule(14)) {
  for (std::size_t n = 0; n < modes_; ++n) {
    pole_.set(n, modes.pole[n]);
    state_.set(n, modes.initial[n]);
    inverse_mass_[n] = inverse_mass[n];
    quadrature_[n] = modes.quadrature[n];
    loss_[n] = -2.0 * modes.pole[n].real() / inverse_mass[n];
    fastest_ = std::max(fastest_, std::abs(modes.pole[n]));
  }
}

ModeReplay::ModeReplay(const ContactModes& modes) : ModeReplay(modes, modes.drive) {
  shape_.assign(1, AlignedVector(padded_size(modes_), 1.0));
}

ModeReplay::ModeReplay(const LineModes& modes) : ModeReplay(modes, modes.inverse_mass) {
  for (const std::vector<double>& shape : modes.shape) {
    shape_.emplace_back(padded_size(modes_));
    std::copy(shape.begin(), shape.end(), shape_.back().begin());
  }
}

// Behind the last coefficient of the force a term falls by |λ|h/(p + 1) from the one before.
std::size_t ModeReplay::terms(double phase, std::size_t forces) const {
  std::size_t p = forces + 1;
  double size = 1.0;
  for (std::size_t k = 1; k < p; ++k) size *= std::min(1.0, phase / static_cast<double>(k));
  // A force of few coefficients need not fall with them: it counts from its last one on.
  if (forces < 8) size = 1.0;
  while (size > 1e-18 && p < kMostReplayTerms) size *= phase / static_cast<double>(p++);
  return p;
}

double ModeReplay::advance(double time, std::span<const std::span<const double>> force,
                           PointPowers& velocity) {
  const double phase = fastest_ * time;
  assert(phase <= kLongestPhase && force.size() == shape_.size() && force.size() <= 16);
  const std::size_t count = terms(phase, force[0].size());
  velocity.assign(force.size(), std::vector<double>(count));
  // The rule of 8 points misses e^{2iφθ} by (2φ)¹⁶ (8!)⁴/(17 (16!)³): 5e-15 at φ = 1.7; that of 14
  // by less at 4.
  const ReplayTask task{pole_, inverse_mass_, quadrature_,
                        loss_, shape_,        time,
                        count, force,         phase <= 1.7 ? few_ : many_};
  return HWY_DYNAMIC_DISPATCH(ReplayModes)(task, state_, velocity);
}

double ModeReplay::energy(const PlanarVector& state) const {
  double sum = 0.0;
  for (std::size_t n = 0; n < modes_; ++n) {
    const double v = state.re[n] - quadrature_[n] * state.im[n];
    const double y = compliance_[n] * state.im[n];
    sum += 0.5 * (v * v + std::norm(pole_.at(n)) * y * y) / inverse_mass_[n];
  }
  return sum;
}

}  // namespace modcal
#endif
