// The string's modes under the observer, a step at a time. Compiled once for every instruction set:
// include it after <hwy/highway.h>, outside any namespace.
#if defined(MODCAL_OBSERVER_MODES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODCAL_OBSERVER_MODES_INL
#undef MODCAL_OBSERVER_MODES_INL
#else
#define MODCAL_OBSERVER_MODES_INL
#endif

#include "libinverse/observer/string_tables.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::observer::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most 8 lanes, the padding of the tables.
using Tag = hn::CappedTag<double, kVectorPadding>;
using Vector = hn::Vec<Tag>;

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
    const double *f_re = factor.re.data(), *f_im = factor.im.data();
    const double *r_re = row.re.data(), *r_im = row.im.data();
    const auto drive = hn::Set(Tag(), u);
    return Transform([=](std::size_t i, Vector& re, Vector& im) HWY_ATTR {
      const Tag d;
      re = hn::MulAdd(hn::Load(d, r_re + i), drive, re);
      im = hn::MulAdd(hn::Load(d, r_im + i), drive, im);
      Turn(hn::Load(d, f_re + i), hn::Load(d, f_im + i), re, im);
    });
  }
  // X ← factor X + row u.
  HWY_INLINE Motion TurnThenAdd(const PlanarVector& factor, const PlanarVector& row, double u) {
    const double *f_re = factor.re.data(), *f_im = factor.im.data();
    const double *r_re = row.re.data(), *r_im = row.im.data();
    const auto drive = hn::Set(Tag(), u);
    return Transform([=](std::size_t i, Vector& re, Vector& im) HWY_ATTR {
      const Tag d;
      Turn(hn::Load(d, f_re + i), hn::Load(d, f_im + i), re, im);
      re = hn::MulAdd(hn::Load(d, r_re + i), drive, re);
      im = hn::MulAdd(hn::Load(d, r_im + i), drive, im);
    });
  }
  // X ← X + first u + second w.
  HWY_INLINE Motion Add(const PlanarVector& first, double u, const PlanarVector& second, double w) {
    const double *a_re = first.re.data(), *a_im = first.im.data();
    const double *b_re = second.re.data(), *b_im = second.im.data();
    const auto left = hn::Set(Tag(), u), right = hn::Set(Tag(), w);
    return Transform([=](std::size_t i, Vector& re, Vector& im) HWY_ATTR {
      const Tag d;
      re = hn::MulAdd(hn::Load(d, a_re + i), left, re);
      im = hn::MulAdd(hn::Load(d, a_im + i), left, im);
      re = hn::MulAdd(hn::Load(d, b_re + i), right, re);
      im = hn::MulAdd(hn::Load(d, b_im + i), right, im);
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
    return hn::GetLane(hn::SumOfLanes(d, sum));
  }

 private:
  static HWY_INLINE void Turn(Vector f_re, Vector f_im, Vector& re, Vector& im) {
    const auto turned = hn::NegMulAdd(f_im, im, hn::Mul(f_re, re));
    im = hn::MulAdd(f_re, im, hn::Mul(f_im, re));
    re = turned;
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
    return {hn::GetLane(hn::SumOfLanes(d, velocity)), hn::GetLane(hn::SumOfLanes(d, displacement))};
  }

  std::size_t size_;
  const double *quadrature_, *compliance_;
  double *memory_re_, *memory_im_;
  Vector re_[kVectors > 0 ? kVectors : 1], im_[kVectors > 0 ? kVectors : 1];
};

}  // namespace modcal::observer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
