#include "libsim/dynamics/fixed_step/line_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libsim/dynamics/fixed_step/line_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using LineTag = hn::CappedTag<double, kVectorPadding>;

void AdvanceLine(LineArrays& c, const double* forces, PointMotions& motion) {
  const LineTag d;
  const std::size_t points = c.shape.size();
  hn::Vec<LineTag> velocity[kMostPoints], displacement[kMostPoints];
  for (std::size_t j = 0; j < points; ++j) velocity[j] = displacement[j] = hn::Zero(d);
  for (std::size_t i = 0; i < c.state_re.size(); i += hn::Lanes(d)) {
    auto load = hn::Zero(d);
    for (std::size_t j = 0; j < points; ++j) {
      load = hn::MulAdd(hn::Load(d, c.shape[j].data() + i), hn::Set(d, forces[j]), load);
    }
    load = hn::Mul(load, hn::Load(d, c.inverse_mass.data() + i));
    const auto re = hn::Load(d, c.state_re.data() + i);
    const auto im = hn::Load(d, c.state_im.data() + i);
    const auto r_re = hn::Load(d, c.propagate_re.data() + i);
    const auto r_im = hn::Load(d, c.propagate_im.data() + i);
    const auto new_re = hn::MulAdd(hn::Load(d, c.deferred_re.data() + i), load,
                                   hn::NegMulAdd(r_im, im, hn::Mul(r_re, re)));
    const auto new_im = hn::MulAdd(hn::Load(d, c.deferred_im.data() + i), load,
                                   hn::MulAdd(r_re, im, hn::Mul(r_im, re)));
    hn::Store(new_re, d, c.state_re.data() + i);
    hn::Store(new_im, d, c.state_im.data() + i);
    const auto v = hn::NegMulAdd(hn::Load(d, c.quadrature.data() + i), new_im, new_re);
    const auto y = hn::Mul(hn::Load(d, c.compliance.data() + i), new_im);
    for (std::size_t j = 0; j < points; ++j) {
      const auto phi = hn::Load(d, c.shape[j].data() + i);
      velocity[j] = hn::MulAdd(phi, v, velocity[j]);
      displacement[j] = hn::MulAdd(phi, y, displacement[j]);
    }
  }
  for (std::size_t j = 0; j < points; ++j) {
    motion.velocity[j] = hn::GetLane(hn::SumOfLanes(d, velocity[j]));
    motion.displacement[j] = hn::GetLane(hn::SumOfLanes(d, displacement[j]));
  }
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {

HWY_EXPORT(AdvanceLine);

LineArrays make_line_arrays(const LineModes& modes, const SchemeWeights& w) {
  const auto part = [&modes](auto value) { return padded(modes.size(), 0.0, value); };
  const auto column = [&](const std::vector<double>& values) {
    return part([&values](std::size_t n) { return values[n]; });
  };
  LineArrays c;
  const auto deferred = [&w](std::size_t n) { return w.propagate[n] * w.newer[n] + w.older[n]; };
  c.propagate_re = part([&](std::size_t n) { return w.propagate[n].real(); });
  c.propagate_im = part([&](std::size_t n) { return w.propagate[n].imag(); });
  c.deferred_re = part([&](std::size_t n) { return deferred(n).real(); });
  c.deferred_im = part([&](std::size_t n) { return deferred(n).imag(); });
  c.state_re = part([&](std::size_t n) { return modes.initial[n].real(); });
  c.state_im = part([&](std::size_t n) { return modes.initial[n].imag(); });
  c.inverse_mass = column(modes.inverse_mass);
  c.quadrature = column(modes.quadrature);
  c.compliance = column(modes.compliance);
  c.left_gain = column(modes.left_gain);
  c.right_gain = column(modes.right_gain);
  for (const std::vector<double>& shape : modes.shape) c.shape.push_back(column(shape));
  return c;
}

void advance_line(LineArrays& arrays, const double* forces, PointMotions& motion) {
  HWY_DYNAMIC_DISPATCH(AdvanceLine)(arrays, forces, motion);
}

DirectResponse direct_response(const LineModes& modes, const SchemeWeights& weights) {
  DirectResponse response;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const std::complex<double> d = weights.newer[n] * modes.inverse_mass[n];
    const double v = d.real() - modes.quadrature[n] * d.imag();
    for (std::size_t j = 0; j < modes.points(); ++j) {
      const double phi = modes.shape[j][n];
      response.left[j] += modes.left_gain[n] * phi * d.imag();
      response.right[j] += modes.right_gain[n] * phi * d.imag();
      for (std::size_t i = 0; i < modes.points(); ++i) {
        response.velocity[i][j] += modes.shape[i][n] * phi * v;
        response.displacement[i][j] += modes.shape[i][n] * phi * modes.compliance[n] * d.imag();
      }
    }
  }
  return response;
}

}  // namespace modcal
#endif
