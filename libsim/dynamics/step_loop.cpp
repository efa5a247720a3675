#include "libsim/dynamics/step_loop.hpp"

#include <cmath>

#include "libsim/dynamics/contact_rule.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libsim/dynamics/step_loop.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

struct ContactSums {
  double velocity;
  double displacement;
};

// At most 8 lanes, the padding of the coefficients.
using Tag = hn::CappedTag<double, kVectorPadding>;

// The arrays of the coefficients, read once: a store into the state could otherwise change the
// vectors' own pointers, and every step would load them again.
struct Arrays {
  explicit Arrays(StepCoefficients& c)
      : size(c.velocity.size()),
        vv(c.vv.data()),
        vy(c.vy.data()),
        yv(c.yv.data()),
        yy(c.yy.data()),
        deferred_velocity(c.deferred_velocity.data()),
        deferred_displacement(c.deferred_displacement.data()),
        velocity(c.velocity.data()),
        displacement(c.displacement.data()) {}
  std::size_t size;
  const double *vv, *vy, *yv, *yy, *deferred_velocity, *deferred_displacement;
  double *velocity, *displacement;
};

// Sums over the lanes of both vectors, by one tree: the first stage leaves half of each.
HWY_INLINE ContactSums SumsOfLanes(hn::Vec<Tag> velocity, hn::Vec<Tag> displacement) {
  const Tag d;
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  const hn::Half<Tag> half;
  auto sum = hn::Add(hn::InterleaveLower(d, velocity, displacement),
                     hn::InterleaveUpper(d, velocity, displacement));
  const auto folded = hn::Add(hn::LowerHalf(half, sum), hn::UpperHalf(half, sum));
#if HWY_TARGET == HWY_AVX2
  const auto pair = folded;
  const auto pair_tag = half;
#else
  const hn::Half<decltype(half)> pair_tag;
  const auto pair = hn::Add(hn::LowerHalf(pair_tag, folded), hn::UpperHalf(pair_tag, folded));
#endif
  return {hn::GetLane(pair), hn::GetLane(hn::Reverse2(pair_tag, pair))};
#else
  return {hn::GetLane(hn::SumOfLanes(d, velocity)), hn::GetLane(hn::SumOfLanes(d, displacement))};
#endif
}

// One vector of modes of P ← M (P + D u).
HWY_INLINE void AdvanceVector(const Arrays& c, std::size_t i, hn::Vec<Tag> force,
                              hn::Vec<Tag>& velocity, hn::Vec<Tag>& displacement) {
  const Tag d;
  const auto v = hn::MulAdd(hn::Load(d, c.deferred_velocity + i), force, velocity);
  const auto y = hn::MulAdd(hn::Load(d, c.deferred_displacement + i), force, displacement);
  velocity = hn::MulAdd(hn::Load(d, c.vy + i), y, hn::Mul(hn::Load(d, c.vv + i), v));
  displacement = hn::MulAdd(hn::Load(d, c.yv + i), v, hn::Mul(hn::Load(d, c.yy + i), y));
}

// The state in memory: any number of modes.
class StreamedModes {
 public:
  explicit StreamedModes(StepCoefficients& c) : c_(c) {}
  // Σ v_n and Σ y_n of the new P.
  HWY_INLINE ContactSums Advance(double u) {
    const Tag d;
    const auto force = hn::Set(d, u);
    auto sum_v = hn::Zero(d), sum_y = hn::Zero(d);
    for (std::size_t i = 0; i < c_.size; i += hn::Lanes(d)) {
      auto v = hn::Load(d, c_.velocity + i);
      auto y = hn::Load(d, c_.displacement + i);
      AdvanceVector(c_, i, force, v, y);
      hn::Store(v, d, c_.velocity + i);
      hn::Store(y, d, c_.displacement + i);
      sum_v = hn::Add(sum_v, v);
      sum_y = hn::Add(sum_y, y);
    }
    return SumsOfLanes(sum_v, sum_y);
  }
  void Store() {}
  void Load() {}

 private:
  Arrays c_;
};

// The state in registers, 2 kVectors of the 32 that the widest instruction sets have. Written
// out by recursion, not as loops over arrays, which the compiler would keep in memory.
template <std::size_t kVectors>
struct VectorsInRegisters {
  VectorsInRegisters<kVectors - 1> rest;
  hn::Vec<Tag> v, y;

  static constexpr std::size_t kFirst = (kVectors - 1) * hn::MaxLanes(Tag());

  HWY_INLINE void Load(const Arrays& c) {
    rest.Load(c);
    v = hn::Load(Tag(), c.velocity + kFirst);
    y = hn::Load(Tag(), c.displacement + kFirst);
  }
  HWY_INLINE void Store(const Arrays& c) const {
    rest.Store(c);
    hn::Store(v, Tag(), c.velocity + kFirst);
    hn::Store(y, Tag(), c.displacement + kFirst);
  }
  HWY_INLINE void Advance(const Arrays& c, hn::Vec<Tag> force, hn::Vec<Tag>& sum_v,
                          hn::Vec<Tag>& sum_y) {
    rest.Advance(c, force, sum_v, sum_y);
    AdvanceVector(c, kFirst, force, v, y);
    sum_v = kFirst == 0 ? v : hn::Add(sum_v, v);
    sum_y = kFirst == 0 ? y : hn::Add(sum_y, y);
  }
};
template <>
struct VectorsInRegisters<0> {
  HWY_INLINE void Load(const Arrays&) {}
  HWY_INLINE void Store(const Arrays&) const {}
  HWY_INLINE void Advance(const Arrays&, hn::Vec<Tag>, hn::Vec<Tag>&, hn::Vec<Tag>&) {}
};

template <std::size_t kVectors>
class ResidentModes {
 public:
  explicit ResidentModes(StepCoefficients& c) : c_(c) { Load(); }
  HWY_INLINE ContactSums Advance(double u) {
    const Tag d;
    auto sum_v = hn::Zero(d), sum_y = hn::Zero(d);
    vectors_.Advance(c_, hn::Set(d, u), sum_v, sum_y);
    return SumsOfLanes(sum_v, sum_y);
  }
  // Around a call or whatever else needs registers: the compiler is not to keep both the state
  // and a copy of it on the stack, written at every step.
  HWY_INLINE void Load() {
    asm volatile("" : : : "memory");
    vectors_.Load(c_);
  }
  HWY_INLINE void Store() { vectors_.Store(c_); }

 private:
  Arrays c_;
  VectorsInRegisters<kVectors> vectors_;
};

HWY_INLINE double Dot(const AlignedVector& a, const AlignedVector& b) {
  const Tag d;
  auto sum = hn::Zero(d);
  for (std::size_t i = 0; i < a.size(); i += hn::Lanes(d)) {
    sum = hn::MulAdd(hn::Load(d, a.data() + i), hn::Load(d, b.data() + i), sum);
  }
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

template <ForceTiming kTiming, typename Modes, typename Law>
LoopCounts Loop(const StepLoop& loop, const Law& law, StepCoefficients& c) {
  ContactRule<Law> rule(loop.contact, law, loop.time_step, loop.initial_displacement,
                        loop.initial_velocity);
  rule.list_switches(loop.switches);
  const StepCoefficients::Response deferred = c.deferred_response;
  const StepCoefficients::Response direct = c.direct_response;
  if (kTiming == ForceTiming::kImplicit) {
    rule.set_response({direct.velocity, direct.displacement},
                      {deferred.velocity, deferred.displacement});
  }
  double force = rule.initial_force();
  double previous_force = 0.0;
  // Sums of P before the first step: M S_0, as the caller left it.
  ContactSums sums = {0.0, 0.0};
  for (std::size_t i = 0; i < c.velocity.size(); ++i) {
    sums.velocity += c.velocity[i];
    sums.displacement += c.displacement[i];
  }
  Modes modes(c);
  std::uint64_t step = 0;
  LoopCounts counts;
  for (std::size_t sample = 1; sample < loop.samples; ++sample) {
    if (loop.stop.requested()) break;
    double v = 0.0, y = 0.0, driving = 0.0;
    for (std::size_t inner = loop.steps_per_sample; inner > 0; --inner) {
      ++step;
      constexpr bool kImplicit = kTiming == ForceTiming::kImplicit;
      const double u = kImplicit ? force : previous_force;
      const double free_v = sums.velocity + deferred.velocity * u;
      const double free_y = sums.displacement + deferred.displacement * u;
      if (inner == 1) {
        modes.Store();  // reactions need S of this step, which Advance() overwrites
        if (loop.targets.left_reaction) {
          loop.targets.left_reaction[sample] = Dot(c.left_gain, c.displacement) + deferred.left * u;
        }
        if (loop.targets.right_reaction) {
          loop.targets.right_reaction[sample] =
              Dot(c.right_gain, c.displacement) + deferred.right * u;
        }
        modes.Load();
      }
      previous_force = force;
      if constexpr (kImplicit) {
        double now = 0.0;
        if (!rule.implicit_going_on(sums.velocity, sums.displacement, u, step, now)) [[unlikely]] {
          modes.Store();
          now = rule.implicit_force(sums.velocity, sums.displacement, u, step);
          modes.Load();
        }
        force = now;
        driving = force;
      } else {
        driving = force;
      }
      v = free_v + direct.velocity * driving;
      y = free_y + direct.displacement * driving;
      if constexpr (!kImplicit) {
        double now = 0.0;
        if (!rule.explicit_going_on(v, y, step, now)) [[unlikely]] {
          modes.Store();
          now = rule.explicit_force(v, y, step);
          modes.Load();
        }
        force = now;
      }
      // After the contact, whose chain of dependent operations the processor then starts first.
      sums = modes.Advance(u);
    }
    if (loop.targets.left_reaction) {
      loop.targets.left_reaction[sample] += direct.left * driving;
    }
    if (loop.targets.right_reaction) {
      loop.targets.right_reaction[sample] += direct.right * driving;
    }
    if (loop.targets.displacement) loop.targets.displacement[sample] = y;
    if (loop.targets.velocity) loop.targets.velocity[sample] = v;
    if (loop.targets.force) loop.targets.force[sample] = force;
    if (!std::isfinite(v) || !std::isfinite(force)) {
      counts.first_bad_sample = sample;
      break;
    }
  }
  counts.attachments = rule.attachments();
  counts.releases = rule.releases();
  return counts;
}

template <typename Modes>
LoopCounts LoopOf(const StepLoop& loop, StepCoefficients& coefficients) {
  return std::visit(
      [&](const auto& law) {
        return loop.timing == ForceTiming::kImplicit
                   ? Loop<ForceTiming::kImplicit, Modes>(loop, law, coefficients)
                   : Loop<ForceTiming::kPreviousStep, Modes>(loop, law, coefficients);
      },
      loop.law);
}

LoopCounts RunStepLoop(const StepLoop& loop, StepCoefficients& coefficients) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  switch (coefficients.velocity.size() / kVectorPadding) {
    case 1:
      return LoopOf<ResidentModes<1>>(loop, coefficients);
    case 2:
      return LoopOf<ResidentModes<2>>(loop, coefficients);
    case 3:
      return LoopOf<ResidentModes<3>>(loop, coefficients);
    case 4:
      return LoopOf<ResidentModes<4>>(loop, coefficients);
    case 5:
      return LoopOf<ResidentModes<5>>(loop, coefficients);
    case 6:
      return LoopOf<ResidentModes<6>>(loop, coefficients);
    case 7:
      return LoopOf<ResidentModes<7>>(loop, coefficients);
    case 8:
      return LoopOf<ResidentModes<8>>(loop, coefficients);
    default:
      break;
  }
#endif
  return LoopOf<StreamedModes>(loop, coefficients);
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(RunStepLoop);

namespace {

AlignedVector padded(const std::vector<double>& values) {
  AlignedVector result(values.begin(), values.end());
  result.resize(padded_size(values.size()), 0.0);
  return result;
}

using ComplexVector = std::vector<std::complex<double>>;

// The part of every Z that is the velocity of the contact, and the part that is its displacement.
AlignedVector velocities(const ContactModes& modes, const ComplexVector& state) {
  std::vector<double> parts;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    parts.push_back(state[n].real() - modes.quadrature[n] * state[n].imag());
  }
  return padded(parts);
}

AlignedVector displacements(const ContactModes& modes, const ComplexVector& state) {
  std::vector<double> parts;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    parts.push_back(modes.compliance[n] * state[n].imag());
  }
  return padded(parts);
}

AlignedVector per_displacement(const ContactModes& modes, const std::vector<double>& gain) {
  std::vector<double> parts;
  for (std::size_t n = 0; n < modes.size(); ++n) parts.push_back(gain[n] / modes.compliance[n]);
  return padded(parts);
}

// Z ← r Z in the coordinates v = Re Z − κ Im Z, y = Im Z/ω_d.
void fill_propagator(const ContactModes& modes, const ComplexVector& propagate,
                     StepCoefficients& c) {
  std::vector<double> vv, vy, yv, yy;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const double a = propagate[n].real(), b = propagate[n].imag();
    const double k = modes.quadrature[n];
    vv.push_back(a - k * b);
    vy.push_back(-b * (1.0 + k * k) / modes.compliance[n]);
    yv.push_back(b * modes.compliance[n]);
    yy.push_back(a + k * b);
  }
  c.vv = padded(vv);
  c.vy = padded(vy);
  c.yv = padded(yv);
  c.yy = padded(yy);
}

StepCoefficients::Response response_of(const ContactModes& modes, const ComplexVector& state) {
  StepCoefficients::Response sum;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    sum.velocity += state[n].real() - modes.quadrature[n] * state[n].imag();
    sum.displacement += modes.compliance[n] * state[n].imag();
    sum.left += modes.left_gain[n] * state[n].imag();
    sum.right += modes.right_gain[n] * state[n].imag();
  }
  return sum;
}

}  // namespace

StepCoefficients make_step_coefficients(const ContactModes& modes, const SchemeWeights& weights,
                                        double initial_force) {
  const std::size_t size = modes.size();
  ComplexVector direct(size), deferred(size), state(size);
  for (std::size_t n = 0; n < size; ++n) {
    direct[n] = modes.drive[n] * weights.newer[n];
    deferred[n] = weights.propagate[n] * direct[n] + modes.drive[n] * weights.older[n];
    state[n] = weights.propagate[n] * (modes.initial[n] - direct[n] * initial_force);
  }
  StepCoefficients c;
  fill_propagator(modes, weights.propagate, c);
  c.deferred_velocity = velocities(modes, deferred);
  c.deferred_displacement = displacements(modes, deferred);
  c.left_gain = per_displacement(modes, modes.left_gain);
  c.right_gain = per_displacement(modes, modes.right_gain);
  c.velocity = velocities(modes, state);
  c.displacement = displacements(modes, state);
  c.deferred_response = response_of(modes, deferred);
  c.direct_response = response_of(modes, direct);
  return c;
}

LoopCounts run_step_loop(const StepLoop& loop, StepCoefficients& coefficients) {
  return HWY_DYNAMIC_DISPATCH(RunStepLoop)(loop, coefficients);
}

}  // namespace modcal
#endif
