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

// P ← r (P + D u); returns Σ (Re P − κ Im P) and Σ Im P/ω_d of the new P.
HWY_INLINE ContactSums AdvanceModes(StepCoefficients& c, double u) {
  const hn::ScalableTag<double> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto force = hn::Set(d, u);
  auto velocity = hn::Zero(d);
  auto displacement = hn::Zero(d);
  double* HWY_RESTRICT state_re = c.state_re.data();
  double* HWY_RESTRICT state_im = c.state_im.data();
  for (std::size_t i = 0; i < c.state_re.size(); i += lanes) {
    const auto re = hn::MulAdd(hn::LoadU(d, &c.deferred_re[i]), force, hn::LoadU(d, state_re + i));
    const auto im = hn::MulAdd(hn::LoadU(d, &c.deferred_im[i]), force, hn::LoadU(d, state_im + i));
    const auto r_re = hn::LoadU(d, &c.propagate_re[i]);
    const auto r_im = hn::LoadU(d, &c.propagate_im[i]);
    const auto new_re = hn::NegMulAdd(r_im, im, hn::Mul(r_re, re));
    const auto new_im = hn::MulAdd(r_re, im, hn::Mul(r_im, re));
    hn::StoreU(new_re, d, state_re + i);
    hn::StoreU(new_im, d, state_im + i);
    velocity = hn::NegMulAdd(hn::LoadU(d, &c.quadrature[i]), new_im, hn::Add(velocity, new_re));
    displacement = hn::MulAdd(hn::LoadU(d, &c.compliance[i]), new_im, displacement);
  }
  return {hn::GetLane(hn::SumOfLanes(d, velocity)), hn::GetLane(hn::SumOfLanes(d, displacement))};
}

HWY_INLINE double Dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

template <ForceTiming kTiming, typename Law>
LoopCounts Loop(const StepLoop& loop, const Law& law, StepCoefficients& c) {
  ContactRule<Law> rule(loop.contact, law, loop.time_step, loop.initial_displacement,
                        loop.initial_velocity);
  const StepCoefficients::Response deferred = c.deferred_response;
  const StepCoefficients::Response direct = c.direct_response;
  double force = rule.initial_force();
  double previous_force = 0.0;
  // Sums of P before the first step: r S_0, as the caller left it.
  ContactSums sums = {0.0, 0.0};
  for (std::size_t i = 0; i < c.state_re.size(); ++i) {
    sums.velocity += c.state_re[i] - c.quadrature[i] * c.state_im[i];
    sums.displacement += c.compliance[i] * c.state_im[i];
  }
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
      if (inner == 1) {  // reactions need S of this step, which AdvanceModes overwrites
        if (loop.targets.left_reaction) {
          loop.targets.left_reaction[sample] = Dot(c.left_gain, c.state_im) + deferred.left * u;
        }
        if (loop.targets.right_reaction) {
          loop.targets.right_reaction[sample] = Dot(c.right_gain, c.state_im) + deferred.right * u;
        }
      }
      sums = AdvanceModes(c, u);
      previous_force = force;
      if constexpr (kImplicit) {
        force = rule.implicit_force(free_v, direct.velocity, free_y, direct.displacement, step);
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

LoopCounts RunStepLoop(const StepLoop& loop, StepCoefficients& coefficients) {
  return std::visit(
      [&](const auto& law) {
        return loop.timing == ForceTiming::kImplicit
                   ? Loop<ForceTiming::kImplicit>(loop, law, coefficients)
                   : Loop<ForceTiming::kPreviousStep>(loop, law, coefficients);
      },
      loop.law);
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(RunStepLoop);

namespace {

// Whole vectors of the widest instruction set in use (8 doubles), so that no kernel has a tail.
constexpr std::size_t kPadding = 8;

std::vector<double> padded(std::vector<double> values) {
  values.resize((values.size() + kPadding - 1) / kPadding * kPadding, 0.0);
  return values;
}

using ComplexVector = std::vector<std::complex<double>>;

std::vector<double> padded_real(const ComplexVector& values) {
  std::vector<double> parts;
  for (const auto& value : values) parts.push_back(value.real());
  return padded(std::move(parts));
}

std::vector<double> padded_imag(const ComplexVector& values) {
  std::vector<double> parts;
  for (const auto& value : values) parts.push_back(value.imag());
  return padded(std::move(parts));
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
