#include "libsim/dynamics/event/modes/mode_replay.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libsim/dynamics/event/modes/mode_replay.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef MODCAL_EVENT_MODE_REPLAY_TYPES
#define MODCAL_EVENT_MODE_REPLAY_TYPES
namespace modcal::event {

// The most that ModeReplay::terms() asks for, at 4 radians, is 35.
inline constexpr std::size_t kMostReplayTerms = 64;

struct ReplayTask {
  const PlanarVector& pole;
  const AlignedVector &drive, &quadrature, &loss;
  double time;
  std::size_t terms;
  std::span<const double> force;
  const GaussRule& rule;
};

}  // namespace modcal::event
#endif

#include "libsim/dynamics/event/modes/planar_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::event::HWY_NAMESPACE {

// Weighted sum of the squares of Σ series[p] θ^p at kNodes points, side by side: a chain of
// multiply-adds each.
template <std::size_t kNodes>
HWY_INLINE Vec Squares(const Vec* series, std::size_t terms, const double* node,
                       const double* weight) {
  const Tag d;
  Vec value[kNodes];
  for (std::size_t g = 0; g < kNodes; ++g) value[g] = series[terms - 1];
  for (std::size_t p = terms - 1; p-- > 0;) {
    for (std::size_t g = 0; g < kNodes; ++g) {
      value[g] = hn::MulAdd(value[g], hn::Set(d, node[g]), series[p]);
    }
  }
  Vec sum = hn::Zero(d);
  for (std::size_t g = 0; g < kNodes; ++g) {
    sum = hn::MulAdd(hn::Mul(value[g], value[g]), hn::Set(d, weight[g]), sum);
  }
  return sum;
}

double ReplayModes(const ReplayTask& task, PlanarVector& state, double* velocity) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const double* node = task.rule.node.data();
  const double* weight = task.rule.weight.data();
  double push[kMostReplayTerms] = {}, part[kMostReplayTerms];
  for (std::size_t p = 0; p < task.terms; ++p) {
    part[p] = task.time / static_cast<double>(p + 1);
    if (p < task.force.size()) push[p] = task.force[p] * part[p];
  }
  Vec total[kMostReplayTerms], series[kMostReplayTerms];
  for (std::size_t p = 0; p < task.terms; ++p) total[p] = hn::Zero(d);
  Vec lost = hn::Zero(d);
  for (std::size_t i = 0; i < state.size(); i += lanes) {
    const Vec x = hn::Load(d, &task.pole.re[i]), y = hn::Load(d, &task.pole.im[i]);
    const Vec drive = hn::Load(d, &task.drive[i]), tilt = hn::Load(d, &task.quadrature[i]);
    Vec re = hn::Load(d, &state.re[i]), im = hn::Load(d, &state.im[i]);
    Vec end_re = hn::Zero(d), end_im = end_re;
    for (std::size_t p = 0; p < task.terms; ++p) {
      end_re = hn::Add(end_re, re);
      end_im = hn::Add(end_im, im);
      series[p] = hn::NegMulAdd(tilt, im, re);
      total[p] = hn::Add(total[p], series[p]);
      const Vec scale = hn::Set(d, part[p]);
      const Vec a = hn::Mul(x, scale), b = hn::Mul(y, scale);
      const Vec forced = hn::MulAdd(drive, hn::Set(d, push[p]), hn::Mul(a, re));
      const Vec turned = hn::MulAdd(b, re, hn::Mul(a, im));
      re = hn::NegMulAdd(b, im, forced);
      im = turned;
    }
    hn::Store(end_re, d, &state.re[i]);
    hn::Store(end_im, d, &state.im[i]);
    const Vec square = task.rule.node.size() == 8 ? Squares<8>(series, task.terms, node, weight)
                                                  : Squares<14>(series, task.terms, node, weight);
    lost = hn::MulAdd(square, hn::Load(d, &task.loss[i]), lost);
  }
  for (std::size_t p = 0; p < task.terms; ++p) {
    velocity[p] = hn::GetLane(hn::SumOfLanes(d, total[p]));
  }
  return task.time * hn::GetLane(hn::SumOfLanes(d, lost));
}

}  // namespace modcal::event::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal::event {
HWY_EXPORT(ReplayModes);

ModeReplay::ModeReplay(const ContactModes& modes)
    : modes_(modes.size()),
      pole_(modes_),
      state_(modes_),
      drive_(padded_size(modes_)),
      quadrature_(padded_size(modes_)),
      loss_(padded_size(modes_)),
      compliance_(modes.compliance),
      few_(gauss_rule(8)),
      many_(gauss_rule(14)) {
  for (std::size_t n = 0; n < modes_; ++n) {
    pole_.set(n, modes.pole[n]);
    state_.set(n, modes.initial[n]);
    drive_[n] = modes.drive[n];
    quadrature_[n] = modes.quadrature[n];
    loss_[n] = -2.0 * modes.pole[n].real() / modes.drive[n];
    fastest_ = std::max(fastest_, std::abs(modes.pole[n]));
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

double ModeReplay::advance(double time, std::span<const double> force,
                           std::vector<double>& velocity) {
  const double phase = fastest_ * time;
  assert(phase <= kLongestPhase && force.size() <= 25);
  const std::size_t count = terms(phase, force.size());
  velocity.resize(count);
  // The rule of 8 points misses e^{2iφθ} by (2φ)¹⁶ (8!)⁴/(17 (16!)³): 5e-15 at φ = 1.7; that of 14
  // by less at 4.
  const ReplayTask task{pole_, drive_, quadrature_, loss_,
                        time,  count,  force,       phase <= 1.7 ? few_ : many_};
  return HWY_DYNAMIC_DISPATCH(ReplayModes)(task, state_, velocity.data());
}

double ModeReplay::energy(const PlanarVector& state) const {
  double sum = 0.0;
  for (std::size_t n = 0; n < modes_; ++n) {
    const double v = state.re[n] - quadrature_[n] * state.im[n];
    const double y = compliance_[n] * state.im[n];
    sum += 0.5 * (v * v + std::norm(pole_.at(n)) * y * y) / drive_[n];
  }
  return sum;
}

}  // namespace modcal::event
#endif
