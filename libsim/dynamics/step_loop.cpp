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
      : size(c.state_re.size()),
        propagate_re(c.propagate_re.data()),
        propagate_im(c.propagate_im.data()),
        deferred_re(c.deferred_re.data()),
        deferred_im(c.deferred_im.data()),
        quadrature(c.quadrature.data()),
        compliance(c.compliance.data()),
        state_re(c.state_re.data()),
        state_im(c.state_im.data()) {}
  std::size_t size;
  const double *propagate_re, *propagate_im, *deferred_re, *deferred_im, *quadrature, *compliance;
  double *state_re, *state_im;
};

// One vector of modes of P ← r (P + D u), added to the sums of the contact.
struct VectorSums {
  hn::Vec<Tag> velocity, displacement;

  HWY_INLINE ContactSums Total() const {
    const Tag d;
    return {hn::GetLane(hn::SumOfLanes(d, velocity)), hn::GetLane(hn::SumOfLanes(d, displacement))};
  }
};

HWY_INLINE void AdvanceVector(const Arrays& c, std::size_t i, hn::Vec<Tag> force,
                              hn::Vec<Tag>& state_re, hn::Vec<Tag>& state_im, VectorSums& sums) {
  const Tag d;
  const auto re = hn::MulAdd(hn::Load(d, c.deferred_re + i), force, state_re);
  const auto im = hn::MulAdd(hn::Load(d, c.deferred_im + i), force, state_im);
  const auto r_re = hn::Load(d, c.propagate_re + i);
  const auto r_im = hn::Load(d, c.propagate_im + i);
  state_re = hn::NegMulAdd(r_im, im, hn::Mul(r_re, re));
  state_im = hn::MulAdd(r_re, im, hn::Mul(r_im, re));
  sums.velocity =
      hn::NegMulAdd(hn::Load(d, c.quadrature + i), state_im, hn::Add(sums.velocity, state_re));
  sums.displacement = hn::MulAdd(hn::Load(d, c.compliance + i), state_im, sums.displacement);
}

// The state in memory: any number of modes.
class StreamedModes {
 public:
  explicit StreamedModes(StepCoefficients& c) : c_(c) {}
  // Σ (Re P − κ Im P) and Σ Im P/ω_d of the new P.
  HWY_INLINE ContactSums Advance(double u) {
    const Tag d;
    const auto force = hn::Set(d, u);
    VectorSums sums{hn::Zero(d), hn::Zero(d)};
    for (std::size_t i = 0; i < c_.size; i += hn::Lanes(d)) {
      auto re = hn::Load(d, c_.state_re + i);
      auto im = hn::Load(d, c_.state_im + i);
      AdvanceVector(c_, i, force, re, im, sums);
      hn::Store(re, d, c_.state_re + i);
      hn::Store(im, d, c_.state_im + i);
    }
    return sums.Total();
  }
  void Store() {}

 private:
  Arrays c_;
};

// The state in registers, 2 kVectors of the 32 that the widest instruction sets have.
template <std::size_t kVectors>
class ResidentModes {
 public:
  explicit ResidentModes(StepCoefficients& c) : c_(c) {
    const Tag d;
    for (std::size_t i = 0; i < kVectors; ++i) {
      re_[i] = hn::Load(d, c_.state_re + i * hn::Lanes(d));
      im_[i] = hn::Load(d, c_.state_im + i * hn::Lanes(d));
    }
  }
  HWY_INLINE ContactSums Advance(double u) {
    const Tag d;
    const auto force = hn::Set(d, u);
    VectorSums sums{hn::Zero(d), hn::Zero(d)};
    for (std::size_t i = 0; i < kVectors; ++i) {
      AdvanceVector(c_, i * hn::Lanes(d), force, re_[i], im_[i], sums);
    }
    return sums.Total();
  }
  void Store() {
    const Tag d;
    for (std::size_t i = 0; i < kVectors; ++i) {
      hn::Store(re_[i], d, c_.state_re + i * hn::Lanes(d));
      hn::Store(im_[i], d, c_.state_im + i * hn::Lanes(d));
    }
  }

 private:
  Arrays c_;
  hn::Vec<Tag> re_[kVectors], im_[kVectors];
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
  const StepCoefficients::Response deferred = c.deferred_response;
  const StepCoefficients::Response direct = c.direct_response;
  rule.set_response(direct.velocity, direct.displacement);
  double force = rule.initial_force();
  double previous_force = 0.0;
  // Sums of P before the first step: r S_0, as the caller left it.
  ContactSums sums = {0.0, 0.0};
  for (std::size_t i = 0; i < c.state_re.size(); ++i) {
    sums.velocity += c.state_re[i] - c.quadrature[i] * c.state_im[i];
    sums.displacement += c.compliance[i] * c.state_im[i];
  }
  Modes modes(c);
  std::uint64_t step = 0;
  LoopCounts counts;
  for (std::size_t sample = 1; sample < loop.samples; ++sample) {
    double v = 0.0, y = 0.0, driving = 0.0;
    for (std::size_t inner = loop.steps_per_sample; inner > 0; --inner) {
      ++step;
      constexpr bool kImplicit = kTiming == ForceTiming::kImplicit;
      const double u = kImplicit ? force : previous_force;
      const double free_v = sums.velocity + deferred.velocity * u;
      const double free_y = sums.displacement + deferred.displacement * u;
      if (inner == 1) {
        modes.Store();  // reactions need S of this step, which AdvanceModes overwrites
        if (loop.targets.left_reaction) {
          loop.targets.left_reaction[sample] = Dot(c.left_gain, c.state_im) + deferred.left * u;
        }
        if (loop.targets.right_reaction) {
          loop.targets.right_reaction[sample] = Dot(c.right_gain, c.state_im) + deferred.right * u;
        }
      }
      sums = modes.Advance(u);
      previous_force = force;
      if constexpr (kImplicit) {
        force = rule.implicit_force(free_v, free_y, step);
        driving = force;
      } else {
        driving = force;
      }
      v = free_v + direct.velocity * driving;
      y = free_y + direct.displacement * driving;
      if constexpr (!kImplicit) force = rule.explicit_force(v, y, step);
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
  switch (coefficients.state_re.size() / kVectorPadding) {
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

AlignedVector padded_real(const ComplexVector& values) {
  std::vector<double> parts;
  for (const auto& value : values) parts.push_back(value.real());
  return padded(parts);
}

AlignedVector padded_imag(const ComplexVector& values) {
  std::vector<double> parts;
  for (const auto& value : values) parts.push_back(value.imag());
  return padded(parts);
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
  c.propagate_re = padded_real(weights.propagate);
  c.propagate_im = padded_imag(weights.propagate);
  c.deferred_re = padded_real(deferred);
  c.deferred_im = padded_imag(deferred);
  c.quadrature = padded(modes.quadrature);
  c.compliance = padded(modes.compliance);
  c.left_gain = padded(modes.left_gain);
  c.right_gain = padded(modes.right_gain);
  c.state_re = padded_real(state);
  c.state_im = padded_imag(state);
  c.deferred_response = response_of(modes, deferred);
  c.direct_response = response_of(modes, direct);
  return c;
}

LoopCounts run_step_loop(const StepLoop& loop, StepCoefficients& coefficients) {
  return HWY_DYNAMIC_DISPATCH(RunStepLoop)(loop, coefficients);
}

}  // namespace modcal
#endif
