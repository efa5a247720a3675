// The string's modes under the observer, a step at a time. Compiled once for every instruction set:
// include it after <hwy/highway.h>, outside any namespace.
#if defined(MODCAL_OBSERVER_MODES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODCAL_OBSERVER_MODES_INL
#undef MODCAL_OBSERVER_MODES_INL
#else
#define MODCAL_OBSERVER_MODES_INL
#endif

#include "libinverse/observer/string_tables.hpp"
#include "libsim/base/planar_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::observer::HWY_NAMESPACE {
using namespace modcal::HWY_NAMESPACE;

struct Motion {
  double velocity, displacement;
};

// The modes of the string in registers (kVectors of them) or, with 0, in memory.
template <std::size_t kVectors>
class Modes {
 public:
  Modes(const StringTables& string, PlanarVector& state)
      : size_(string.size()),
        quadrature_(string.quadrature.data()),
        compliance_(string.compliance.data()),
        memory_re_(state.re.data()),
        memory_im_(state.im.data()) {
    for (std::size_t i = 0; i < kVectors; ++i) {
      re_[i] = hn::Load(Tag(), memory_re_ + i * hn::Lanes(Tag()));
      im_[i] = hn::Load(Tag(), memory_im_ + i * hn::Lanes(Tag()));
    }
  }
  void Store() {
    for (std::size_t i = 0; i < kVectors; ++i) {
      hn::Store(re_[i], Tag(), memory_re_ + i * hn::Lanes(Tag()));
      hn::Store(im_[i], Tag(), memory_im_ + i * hn::Lanes(Tag()));
    }
  }

  // X ← factor (X + row u), and the motion at the contact that goes with it.
  HWY_INLINE Motion AddThenTurn(const PlanarVector& factor, const PlanarVector& row, double u) {
    const Source factors(factor), rows(row);
    const auto drive = hn::Set(Tag(), u);
    return Transform([=](std::size_t i, Vector& re, Vector& im) HWY_ATTR {
      AddTo(rows[i], drive, re, im);
      Turn(factors[i], re, im);
    });
  }
  // X ← factor X + row u.
  HWY_INLINE Motion TurnThenAdd(const PlanarVector& factor, const PlanarVector& row, double u) {
    const Source factors(factor), rows(row);
    const auto drive = hn::Set(Tag(), u);
    return Transform([=](std::size_t i, Vector& re, Vector& im) HWY_ATTR {
      Turn(factors[i], re, im);
      AddTo(rows[i], drive, re, im);
    });
  }
  // X ← X + first u + second w.
  HWY_INLINE Motion Add(const PlanarVector& first, double u, const PlanarVector& second, double w) {
    const Source firsts(first), seconds(second);
    const auto left = hn::Set(Tag(), u), right = hn::Set(Tag(), w);
    return Transform([=](std::size_t i, Vector& re, Vector& im) HWY_ATTR {
      AddTo(firsts[i], left, re, im);
      AddTo(seconds[i], right, re, im);
    });
  }
  // Σ gain Im X.
  HWY_INLINE double Reaction(const AlignedVector& gain) {
    const Tag d;
    auto sum = hn::Zero(d);
    const double* g = gain.data();
    if constexpr (kVectors > 0) {
      for (std::size_t i = 0; i < kVectors; ++i) {
        sum = hn::MulAdd(hn::Load(d, g + i * hn::Lanes(d)), im_[i], sum);
      }
    } else {
      for (std::size_t i = 0; i < size_; i += hn::Lanes(d)) {
        sum = hn::MulAdd(hn::Load(d, g + i), hn::Load(d, memory_im_ + i), sum);
      }
    }
    return Total(sum);
  }

 private:
  static HWY_INLINE void Turn(ComplexVector factor, Vector& re, Vector& im) {
    const ComplexVector turned = Times(factor, ComplexVector{re, im});
    re = turned.re;
    im = turned.im;
  }
  static HWY_INLINE void AddTo(ComplexVector row, Vector drive, Vector& re, Vector& im) {
    re = hn::MulAdd(row.re, drive, re);
    im = hn::MulAdd(row.im, drive, im);
  }

  template <typename Change>
  HWY_INLINE Motion Transform(const Change& change) {
    const Tag d;
    auto velocity = hn::Zero(d), displacement = hn::Zero(d);
    const double *quadrature = quadrature_, *compliance = compliance_;
    const auto observe = [&](std::size_t i, Vector re, Vector im) HWY_ATTR {
      velocity = hn::NegMulAdd(hn::Load(d, quadrature + i), im, hn::Add(velocity, re));
      displacement = hn::MulAdd(hn::Load(d, compliance + i), im, displacement);
    };
    if constexpr (kVectors > 0) {
      for (std::size_t j = 0; j < kVectors; ++j) {
        const std::size_t i = j * hn::Lanes(d);
        change(i, re_[j], im_[j]);
        observe(i, re_[j], im_[j]);
      }
    } else {
      for (std::size_t i = 0; i < size_; i += hn::Lanes(d)) {
        auto re = hn::Load(d, memory_re_ + i), im = hn::Load(d, memory_im_ + i);
        change(i, re, im);
        observe(i, re, im);
        hn::Store(re, d, memory_re_ + i);
        hn::Store(im, d, memory_im_ + i);
      }
    }
    return {Total(velocity), Total(displacement)};
  }

  std::size_t size_;
  const double *quadrature_, *compliance_;
  double *memory_re_, *memory_im_;
  Vector re_[kVectors > 0 ? kVectors : 1], im_[kVectors > 0 ? kVectors : 1];
};

}  // namespace modcal::observer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
