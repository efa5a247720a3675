#include "libcalib/identifiability/neighbor_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libcalib/identifiability/neighbor_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libcalib/likelihood/kernels/planar_complex-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

HWY_INLINE V Dot(V sum, C a, C b) { return hn::MulAdd(a.im, b.im, hn::MulAdd(a.re, b.re, sum)); }

// Least squares of e + a x + a' x' by the normal equations of its two unknowns.
double CostWith(const ModeSurroundings& around, const LikelihoodMode& mode) {
  const double turn = mode.even ? 1.0 : -1.0;
  const V per_left = Real(1.0 / around.deviation[0]);
  const V per_right = Real(turn / around.deviation[1]);
  const V residue = Real(mode.residue);
  const bool decays = around.sigma == 0.0 && mode.decays;
  V own = hn::Zero(D());
  V first_own = own, second_own = own, first_both = own, second_both = own, mixed = own;
  for (std::size_t k = 0; k < around.omega.size(); k += hn::Lanes(D())) {
    const Bins bins = BinsAt(around.omega.data() + k, around.sigma);
    const C sensor = Load(around.sensor, k);
    const C receptance = Scale(InverseDenominator(mode, bins), residue);
    const C left = Sub(Load(around.left, k), Scale(receptance, per_left));
    const C right = AddMul(Load(around.right, k), Scale(receptance, per_right), sensor);
    const V variance = ResidualVariance(left, right, LoadReal(around.left_noise.data() + k),
                                        LoadReal(around.right_noise.data() + k),
                                        LoadReal(around.mixed_noise.data() + k));
    const V scale = hn::Div(LoadReal(around.weight.data() + k), hn::Sqrt(variance));
    const C data =
        Sub(Mul(right, Load(around.left_data, k)), Mul(left, Load(around.right_data, k)));
    const C residual = Scale(data, scale);
    own = hn::Add(own, Norm(residual));
    if (!decays) continue;
    const C kappa = Scale(AddMul(Scale(right, per_left), Scale(left, per_right), sensor), scale);
    const Decays decay = DecaysAt(mode.pole, Load(around.delay, k));
    const C first = Mul(kappa, Add(decay.u, decay.u_conj));
    const C turned = Mul(kappa, Sub(decay.u, decay.u_conj));
    const C second = Make(hn::Neg(turned.im), turned.re);
    first_own = hn::Add(first_own, Norm(first));
    second_own = hn::Add(second_own, Norm(second));
    mixed = Dot(mixed, first, second);
    first_both = Dot(first_both, first, residual);
    second_both = Dot(second_both, second, residual);
  }
  const double cost = Sum(own);
  if (!decays) return cost;
  const double a = Sum(first_own), b = Sum(second_own), c = Sum(mixed);
  const double p = Sum(first_both), q = Sum(second_both);
  const double determinant = a * b - c * c;
  if (!(determinant > 1e-12 * a * b)) return cost - (a > 0.0 ? p * p / a : 0.0);
  return cost - (b * p * p - 2.0 * c * p * q + a * q * q) / determinant;
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(CostWith);

ModeSurroundings::ModeSurroundings(std::size_t bins)
    : left(bins),
      right(bins),
      left_data(bins),
      right_data(bins),
      left_noise(padded_size(bins)),
      right_noise(padded_size(bins)),
      mixed_noise(padded_size(bins)),
      sensor(bins),
      delay(bins),
      omega(padded_size(bins)),
      weight(padded_size(bins)) {}

double cost_with(const ModeSurroundings& around, const LikelihoodMode& mode) {
  return HWY_DYNAMIC_DISPATCH(CostWith)(around, mode);
}
}  // namespace modcal
#endif
