
#include "libsim/dynamics/event/sliding/contact_friction.hpp"
#include "libsim/dynamics/event/sliding/tuning.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libsim/dynamics/event/sliding/collocation.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace modcal::event::HWY_NAMESPACE {

// Elimination of column k and all later ones; A is I + (small), so that its diagonal serves as
// pivots. Recursive, so that every index is a constant. False where a pivot vanishes.
template <int k, int kSize>
HWY_INLINE bool Eliminate(double (&a)[kSize][kSize], double (&b)[kSize]) {
  const bool regular = std::abs(a[k][k]) > 1e-12;
  const double inverse = 1.0 / a[k][k];
  a[k][k] = inverse;
  for (int i = k + 1; i < kSize; ++i) {
    const double factor = a[i][k] * inverse;
    for (int j = k + 1; j < kSize; ++j) a[i][j] -= factor * a[k][j];
    b[i] -= factor * b[k];
  }
  if constexpr (k + 1 < kSize) return regular & Eliminate<k + 1>(a, b);
  return regular;
}

// x ← x − A⁻¹ b from row k upwards; b becomes A⁻¹ b.
template <int k, int kSize>
HWY_INLINE void SubtractBack(const double (&a)[kSize][kSize], double (&b)[kSize],
                             double (&x)[kSize]) {
  for (int j = k + 1; j < kSize; ++j) b[k] -= a[k][j] * b[j];
  b[k] *= a[k][k];
  x[k] -= b[k];
  if constexpr (k > 0) SubtractBack<k - 1>(a, b, x);
}

// b ← A⁻¹ b of a 2 by 2 block.
struct Block2 {
  double inverse[2][2];
  HWY_INLINE bool Invert(double a, double b, double c, double d) {
    const double determinant = a * d - b * c, scale = 1.0 / determinant;
    inverse[0][0] = scale * d;
    inverse[0][1] = -scale * b;
    inverse[1][0] = -scale * c;
    inverse[1][1] = scale * a;
    return std::abs(determinant) > 1e-12;
  }
  HWY_INLINE double First(double x, double y) const {
    return inverse[0][0] * x + inverse[0][1] * y;
  }
  HWY_INLINE double Second(double x, double y) const {
    return inverse[1][0] * x + inverse[1][1] * y;
  }
};

// x ← x − A⁻¹ b; b becomes A⁻¹ b. False where A is singular.
template <int kSize>
HWY_INLINE bool NewtonStep(double (&a)[kSize][kSize], double (&b)[kSize], double (&x)[kSize]) {
  if constexpr (kSize == 4) {
    // By blocks: two divisions wait for each other instead of four.
    Block2 upper, lower;
    bool regular = upper.Invert(a[0][0], a[0][1], a[1][0], a[1][1]);
    double q[2][2];
    for (int j = 0; j < 2; ++j) {
      q[0][j] = upper.First(a[0][2 + j], a[1][2 + j]);
      q[1][j] = upper.Second(a[0][2 + j], a[1][2 + j]);
    }
    const double y0 = upper.First(b[0], b[1]), y1 = upper.Second(b[0], b[1]);
    double s[2][2], r[2];
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        s[i][j] = a[2 + i][2 + j] - (a[2 + i][0] * q[0][j] + a[2 + i][1] * q[1][j]);
      }
      r[i] = b[2 + i] - (a[2 + i][0] * y0 + a[2 + i][1] * y1);
    }
    regular &= lower.Invert(s[0][0], s[0][1], s[1][0], s[1][1]);
    b[2] = lower.First(r[0], r[1]);
    b[3] = lower.Second(r[0], r[1]);
    b[0] = y0 - (q[0][0] * b[2] + q[0][1] * b[3]);
    b[1] = y1 - (q[1][0] * b[2] + q[1][1] * b[3]);
    for (int i = 0; i < 4; ++i) x[i] -= b[i];
    return regular;
  } else {
    if (!Eliminate<0>(a, b)) return false;
    SubtractBack<kSize - 1>(a, b, x);
    return true;
  }
}

// The law at the unknown nodes 2…s, below u = 0 continued smoothly.
template <int kUnknowns>
struct LawValues {
  // Whole vectors: the compiler then computes the nodes side by side.
  // Fixed by: unknown nodes of the largest rule, kMaxNodes − 1.
  static constexpr int kPadded = 4;
  double force[kPadded], slope[kPadded], curvature[kPadded];

  template <typename Law>
  void evaluate(const Law& law, const double (&speed)[kUnknowns], const double* load) {
    double sliding[kPadded] = {}, factor[kPadded] = {};
    double lowest = 0.0;
    for (int i = 0; i < kUnknowns; ++i) {
      factor[i] = load[i];
      sliding[i] = speed[i] < 0.0 ? 0.0 : speed[i];
      lowest = speed[i] < lowest ? speed[i] : lowest;
    }
#pragma GCC unroll 1
    for (int i = 0; i < kPadded; ++i) {
      const auto point = law.at(sliding[i]);
      force[i] = factor[i] * point.force;
      slope[i] = factor[i] * point.slope;
      curvature[i] = factor[i] * point.curvature;
    }
    if (lowest < 0.0) continue_below(speed);
  }
  void continue_below(const double (&speed)[kUnknowns]) {
    for (int i = 0; i < kUnknowns; ++i) {
      if (!(speed[i] < 0.0)) continue;
      // To where the slope has doubled by the parabola, by the tangent beyond.
      const bool far = slope[i] < 0.0 && curvature[i] * speed[i] < slope[i];
      const double bent = far ? slope[i] / curvature[i] : speed[i];
      const double bend = curvature[i] * bent;
      force[i] += bent * (slope[i] + 0.5 * bend);
      slope[i] += bend;
      force[i] += (speed[i] - bent) * slope[i];
      if (far) curvature[i] = 0.0;
    }
  }
  // Carries the values over to speeds that differ by −step, by the law's parabola.
  void shift(const double (&step)[kUnknowns]) {
    for (int i = 0; i < kUnknowns; ++i) {
      force[i] -= step[i] * (slope[i] - 0.5 * step[i] * curvature[i]);
      slope[i] -= step[i] * curvature[i];
    }
  }
};

// The residual that a Newton step leaves is ½ coupling g'' step²; where it is below the tight bound
// (and the parabola's own remainder with it) the law need not be computed again. A step from far
// off leaves the rounding of what it started from. `size`: Σ |coupling| of the equation, `scale`:
// what its terms amount to.
template <int kUnknowns>
HWY_INLINE bool LeavesRounding(const LawValues<kUnknowns>& at, const double (&step)[kUnknowns],
                               const double (&size)[kUnknowns], const double (&scale)[kUnknowns]) {
  double bend = 0.0;
  for (int j = 0; j < kUnknowns; ++j) {
    bend = std::max(bend, 0.5 * std::abs(at.curvature[j]) * step[j] * step[j]);
  }
  bool rounding = true;
  for (int i = 0; i < kUnknowns; ++i) {
    rounding =
        rounding && size[i] * bend <= kTightNodes * scale[i] && std::abs(step[i]) <= scale[i];
  }
  return rounding;
}

template <int kNodes, typename Law>
bool SolveNodesOf(const Law& law, const NodeMatrix& coupling, const NodeVector& free,
                  NodeValues& values) {
  constexpr int kUnknowns = kNodes - 1;
  double speed[kUnknowns], scale[kUnknowns], known[kUnknowns], size[kUnknowns];
  for (int i = 0; i < kUnknowns; ++i) {
    known[i] = free[i + 1] - coupling[i + 1][0] * values.friction[0];
    size[i] = 0.0;
    for (int j = 1; j < kNodes; ++j) size[i] += std::abs(coupling[i + 1][j]);
    scale[i] = std::abs(free[i + 1]);
    speed[i] = values.speed[i + 1];
  }
  LawValues<kUnknowns> at;
  double previous = HUGE_VAL;
  bool solved = false;
  for (int iteration = 0; iteration < kNewtonSteps && !solved; ++iteration) {
    at.evaluate(law, speed, &values.load[1]);
    if (iteration == 0) {
      const double largest = *std::max_element(at.force, at.force + kUnknowns);
      for (int i = 0; i < kUnknowns; ++i) {
        scale[i] += size[i] * std::max(largest, values.friction[0]);
      }
    }
    double step[kUnknowns];
    double worst = 0.0;
    for (int i = 0; i < kUnknowns; ++i) {
      double sum = speed[i] - known[i];
      for (int j = 0; j < kUnknowns; ++j) sum += coupling[i + 1][j + 1] * at.force[j];
      step[i] = sum;
      // Below the tight bound nothing is left to compare: one test of the common case.
      if (!(std::abs(sum) <= kTightNodes * scale[i])) {
        worst = std::max(worst, std::isfinite(sum) ? std::abs(sum) / scale[i] : HUGE_VAL);
      }
    }
    if (worst == 0.0 || (worst <= kAcceptableNodes && worst >= 0.5 * previous)) break;
    if (worst == HUGE_VAL) return false;
    previous = worst;
    double jacobian[kUnknowns][kUnknowns];
    for (int i = 0; i < kUnknowns; ++i) {
      for (int j = 0; j < kUnknowns; ++j) {
        jacobian[i][j] = coupling[i + 1][j + 1] * at.slope[j] + (i == j ? 1.0 : 0.0);
      }
    }
    if (!NewtonStep(jacobian, step, speed)) return false;
    solved = LeavesRounding(at, step, size, scale);
    if (solved) at.shift(step);
    if (iteration + 1 == kNewtonSteps && !solved) return false;
  }
  for (int i = 0; i < kUnknowns; ++i) {
    values.speed[i + 1] = speed[i];
    values.friction[i + 1] = at.force[i];
    values.slope[i + 1] = at.slope[i];
  }
  return true;
}

bool SolveNodes(const SlidingLaw& any_law, int nodes, const NodeMatrix& coupling,
                const NodeVector& free, NodeValues& values) {
  return std::visit(
      [&](const auto& law) {
        if (nodes == 2) return SolveNodesOf<2>(law, coupling, free, values);
        if (nodes == 3) return SolveNodesOf<3>(law, coupling, free, values);
        if (nodes == 4) return SolveNodesOf<4>(law, coupling, free, values);
        return SolveNodesOf<5>(law, coupling, free, values);
      },
      any_law);
}

}  // namespace modcal::event::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal::event {
HWY_EXPORT(SolveNodes);

bool solve_nodes(const SlidingLaw& law, int nodes, const NodeMatrix& coupling,
                 const NodeVector& free, NodeValues& values) {
  return HWY_DYNAMIC_DISPATCH(SolveNodes)(law, nodes, coupling, free, values);
}
}  // namespace modcal::event
#endif
