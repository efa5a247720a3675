// The modes of the fixed-step loop, a step at a time. Compiled once for every instruction set:
// include it after <hwy/highway.h>, outside any namespace.
#if defined(MODCAL_STEPPED_MODES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODCAL_STEPPED_MODES_INL
#undef MODCAL_STEPPED_MODES_INL
#else
#define MODCAL_STEPPED_MODES_INL
#endif

#include "libsim/base/planar_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

// A ModeSum by its arrays.
struct SumWeights {
  explicit SumWeights(const ModeSum& sum)
      : first(sum.first.data()), second(sum.second.data()), kick(sum.kick) {}
  const double *first, *second;
  double kick;
};

// The arrays of the coefficients, read once: a store into the state could otherwise change the
// vectors' own pointers, and every step would load them again.
struct ModeArrays {
  explicit ModeArrays(StepCoefficients& c)
      : size(c.first.size()),
        decay(c.decay.data()),
        turn(c.turn.data()),
        first(c.first.data()),
        second(c.second.data()) {}
  std::size_t size;
  const double *decay, *turn;
  double *first, *second;
};

HWY_INLINE double SumOfLanes(Vector sum) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  // A tree whose stages halve the vector: Highway's own keeps all lanes busy.
  const Tag d;
  const hn::Half<Tag> half;
  const hn::Half<decltype(half)> quarter;
  const auto four = hn::Add(hn::LowerHalf(half, sum), hn::UpperHalf(half, sum));
  const auto two = hn::Add(hn::LowerHalf(quarter, four), hn::UpperHalf(quarter, four));
  return hn::GetLane(two) + hn::GetLane(hn::Reverse2(quarter, two));
#else
  return modcal::HWY_NAMESPACE::Total(sum);
#endif
}

// Two partial sums: a chain of dependent additions half as long.
struct PartialSums {
  Vector first, second;
  HWY_INLINE void Add(const SumWeights& weights, std::size_t i, Vector x1, Vector x2) {
    first = hn::MulAdd(hn::Load(Tag(), weights.first + i), x1, first);
    second = hn::MulAdd(hn::Load(Tag(), weights.second + i), x2, second);
  }
  HWY_INLINE double Total() const { return SumOfLanes(hn::Add(first, second)); }
};
HWY_INLINE PartialSums NoSums() { return {hn::Zero(Tag()), hn::Zero(Tag())}; }

// x₂ ← x₂ + u, x₁ ← x₁ + x₂, x₂ ← d x₂ − a x₁ of one vector of modes.
HWY_INLINE void AdvanceVector(const ModeArrays& c, std::size_t i, Vector force, Vector& x1,
                              Vector& x2) {
  const Tag d;
  x2 = hn::Add(x2, force);
  x1 = hn::Add(x1, x2);
  x2 = hn::NegMulAdd(hn::Load(d, c.turn + i), x1, hn::Mul(hn::Load(d, c.decay + i), x2));
}

// The state in memory: any number of modes.
class StreamedModes {
 public:
  explicit StreamedModes(StepCoefficients& c) : c_(c) {}
  // Takes the force u and a step; returns the sum without any further force.
  HWY_INLINE double Advance(double u, const SumWeights& weights) {
    const Tag d;
    const auto force = hn::Set(d, u);
    PartialSums sums = NoSums();
    for (std::size_t i = 0; i < c_.size; i += hn::Lanes(d)) {
      auto x1 = hn::Load(d, c_.first + i), x2 = hn::Load(d, c_.second + i);
      AdvanceVector(c_, i, force, x1, x2);
      hn::Store(x1, d, c_.first + i);
      hn::Store(x2, d, c_.second + i);
      sums.Add(weights, i, x1, x2);
    }
    return sums.Total();
  }
  HWY_INLINE double Sum(const SumWeights& weights) const {
    const Tag d;
    PartialSums sums = NoSums();
    for (std::size_t i = 0; i < c_.size; i += hn::Lanes(d)) {
      sums.Add(weights, i, hn::Load(d, c_.first + i), hn::Load(d, c_.second + i));
    }
    return sums.Total();
  }
  void Store() {}
  void Load() {}

 private:
  ModeArrays c_;
};

// The state in registers, 2 kVectors of the 32 that the widest instruction sets have. Written
// out by recursion, not as loops over arrays, which the compiler would keep in memory.
template <std::size_t kVectors>
struct VectorsInRegisters {
  VectorsInRegisters<kVectors - 1> rest;
  Vector x1, x2;

  static constexpr std::size_t kFirst = (kVectors - 1) * hn::MaxLanes(Tag());

  HWY_INLINE void Load(const ModeArrays& c) {
    rest.Load(c);
    x1 = hn::Load(Tag(), c.first + kFirst);
    x2 = hn::Load(Tag(), c.second + kFirst);
  }
  HWY_INLINE void Store(const ModeArrays& c) const {
    rest.Store(c);
    hn::Store(x1, Tag(), c.first + kFirst);
    hn::Store(x2, Tag(), c.second + kFirst);
  }
  HWY_INLINE void Advance(const ModeArrays& c, Vector force, const SumWeights& weights,
                          PartialSums& sums) {
    rest.Advance(c, force, weights, sums);
    AdvanceVector(c, kFirst, force, x1, x2);
    sums.Add(weights, kFirst, x1, x2);
  }
  HWY_INLINE void Sum(const SumWeights& weights, PartialSums& sums) const {
    rest.Sum(weights, sums);
    sums.Add(weights, kFirst, x1, x2);
  }
};
template <>
struct VectorsInRegisters<0> {
  HWY_INLINE void Load(const ModeArrays&) {}
  HWY_INLINE void Store(const ModeArrays&) const {}
  HWY_INLINE void Advance(const ModeArrays&, Vector, const SumWeights&, PartialSums&) {}
  HWY_INLINE void Sum(const SumWeights&, PartialSums&) const {}
};

template <std::size_t kVectors>
class ResidentModes {
 public:
  explicit ResidentModes(StepCoefficients& c) : c_(c) { Load(); }
  HWY_INLINE double Advance(double u, const SumWeights& weights) {
    PartialSums sums = NoSums();
    vectors_.Advance(c_, hn::Set(Tag(), u), weights, sums);
    return sums.Total();
  }
  HWY_INLINE double Sum(const SumWeights& weights) const {
    PartialSums sums = NoSums();
    vectors_.Sum(weights, sums);
    return sums.Total();
  }
  // Around a call or whatever else needs registers: the compiler is not to keep both the state
  // and a copy of it on the stack, written at every step.
  HWY_INLINE void Load() {
    asm volatile("" : : : "memory");
    vectors_.Load(c_);
  }
  HWY_INLINE void Store() { vectors_.Store(c_); }

 private:
  ModeArrays c_;
  VectorsInRegisters<kVectors> vectors_;
};

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // per target
