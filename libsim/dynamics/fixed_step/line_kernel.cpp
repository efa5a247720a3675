#include "libsim/dynamics/fixed_step/line_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libsim/dynamics/fixed_step/line_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libsim/base/planar_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

void AdvanceLine(LineArrays& c, const double* forces, PointMotions& motion) {
  const Tag d;
  const Source propagate(c.propagate), deferred(c.deferred), states(c.state);
  const Target to(c.state);
  const std::size_t points = c.shape.size();
  Vector velocity[kMostPoints], displacement[kMostPoints];
  for (std::size_t j = 0; j < points; ++j) velocity[j] = displacement[j] = hn::Zero(d);
  for (std::size_t i = 0; i < c.state.size(); i += hn::Lanes(d)) {
    auto load = hn::Zero(d);
    for (std::size_t j = 0; j < points; ++j) {
      load = hn::MulAdd(hn::Load(d, c.shape[j].data() + i), hn::Set(d, forces[j]), load);
    }
    load = hn::Mul(load, hn::Load(d, c.inverse_mass.data() + i));
    const ComplexVector turned = Times(propagate[i], states[i]), weight = deferred[i];
    const ComplexVector z = {hn::MulAdd(weight.re, load, turned.re),
                             hn::MulAdd(weight.im, load, turned.im)};
    to.Set(i, z);
    const auto v = hn::NegMulAdd(hn::Load(d, c.quadrature.data() + i), z.im, z.re);
    const auto y = hn::Mul(hn::Load(d, c.compliance.data() + i), z.im);
    for (std::size_t j = 0; j < points; ++j) {
      const auto phi = hn::Load(d, c.shape[j].data() + i);
      velocity[j] = hn::MulAdd(phi, v, velocity[j]);
      displacement[j] = hn::MulAdd(phi, y, displacement[j]);
    }
  }
  for (std::size_t j = 0; j < points; ++j) {
    motion.velocity[j] = Total(velocity[j]);
    motion.displacement[j] = Total(displacement[j]);
  }
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {

HWY_EXPORT(AdvanceLine);

LineArrays make_line_arrays(const LineModes& modes, const SchemeWeights& w) {
  LineArrays c;
  c.propagate = c.deferred = PlanarVector(modes.size());
  c.state = PlanarVector(modes.initial);
  for (std::size_t n = 0; n < modes.size(); ++n) {
    c.propagate.set(n, w[n].propagate);
    c.deferred.set(n, w[n].propagate * w[n].newer + w[n].older);
  }
  c.inverse_mass = padded(modes.inverse_mass);
  c.quadrature = padded(modes.quadrature);
  c.compliance = padded(modes.compliance);
  c.left_gain = PlanarVector(modes.left_gain);
  c.right_gain = PlanarVector(modes.right_gain);
  for (const std::vector<double>& shape : modes.shape) c.shape.push_back(padded(shape));
  return c;
}

void advance_line(LineArrays& arrays, const double* forces, PointMotions& motion) {
  HWY_DYNAMIC_DISPATCH(AdvanceLine)(arrays, forces, motion);
}

DirectResponse direct_response(const LineModes& modes, const SchemeWeights& weights) {
  DirectResponse response;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const std::complex<double> d = weights[n].newer * modes.inverse_mass[n];
    const double v = modes.motion(n, d).velocity;
    for (std::size_t j = 0; j < modes.points(); ++j) {
      const double phi = modes.shape[j][n];
      response.left[j] += LineModes::reading(modes.left_gain[n] * phi, d);
      response.right[j] += LineModes::reading(modes.right_gain[n] * phi, d);
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
