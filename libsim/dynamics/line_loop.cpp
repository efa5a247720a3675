#include "libsim/dynamics/line_loop.hpp"

#include <cmath>

#include "libsim/dynamics/contact_point.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libsim/dynamics/line_loop.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef MODCAL_LINE_ARRAYS
#define MODCAL_LINE_ARRAYS
namespace modcal {

// One-step coefficients of every mode, padded with zeros to whole vectors. S is the part of Z that
// does not hold the newest force: S ← r S + D u, D = r d₁ + d₀, Z = S + d₁ f, with u = Σ φ_j f_j/m.
struct LineArrays {
  AlignedVector propagate_re, propagate_im, deferred_re, deferred_im;
  AlignedVector inverse_mass, quadrature, compliance, left_gain, right_gain;
  std::vector<AlignedVector> shape;
  AlignedVector state_re, state_im;  // S
};

constexpr std::size_t kMostPoints = 16;

struct PointMotions {
  double velocity[kMostPoints];
  double displacement[kMostPoints];
};

}  // namespace modcal
#endif

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using LineTag = hn::CappedTag<double, kVectorPadding>;

// S ← r S + D Σ φ_j f_j/m and the motion of every point that the new S makes.
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

namespace {

AlignedVector padded(const std::vector<double>& values) {
  AlignedVector result(values.begin(), values.end());
  result.resize(padded_size(values.size()), 0.0);
  return result;
}

template <typename Value>
AlignedVector padded_part(std::size_t size, Value value) {
  std::vector<double> parts(size);
  for (std::size_t n = 0; n < size; ++n) parts[n] = value(n);
  return padded(parts);
}

LineArrays make_arrays(const LineModes& modes, const SchemeWeights& w) {
  const std::size_t size = modes.size();
  LineArrays c;
  const auto deferred = [&w](std::size_t n) { return w.propagate[n] * w.newer[n] + w.older[n]; };
  c.propagate_re = padded_part(size, [&w](std::size_t n) { return w.propagate[n].real(); });
  c.propagate_im = padded_part(size, [&w](std::size_t n) { return w.propagate[n].imag(); });
  c.deferred_re = padded_part(size, [&](std::size_t n) { return deferred(n).real(); });
  c.deferred_im = padded_part(size, [&](std::size_t n) { return deferred(n).imag(); });
  c.state_re = padded_part(size, [&modes](std::size_t n) { return modes.initial[n].real(); });
  c.state_im = padded_part(size, [&modes](std::size_t n) { return modes.initial[n].imag(); });
  c.inverse_mass = padded(modes.inverse_mass);
  c.quadrature = padded(modes.quadrature);
  c.compliance = padded(modes.compliance);
  c.left_gain = padded(modes.left_gain);
  c.right_gain = padded(modes.right_gain);
  for (const std::vector<double>& shape : modes.shape) c.shape.push_back(padded(shape));
  return c;
}

// Response of points and ends to the newest forces (d₁).
struct DirectResponse {
  double velocity[kMostPoints][kMostPoints] = {};
  double displacement[kMostPoints][kMostPoints] = {};
  double left[kMostPoints] = {}, right[kMostPoints] = {};
};

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

double dot(const AlignedVector& a, const AlignedVector& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

double dot(const double* a, const double* b, std::size_t size) {
  double sum = 0.0;
  for (std::size_t i = 0; i < size; ++i) sum += a[i] * b[i];
  return sum;
}

template <typename Point>
class Run {
 public:
  Run(const LineLoop& loop, const LineModes& modes, const SchemeWeights& weights)
      : loop_(loop),
        modes_(modes),
        arrays_(make_arrays(modes, weights)),
        direct_(direct_response(modes, weights)),
        newer_(weights.newer),
        cursor_(loop.bow),
        size_(modes.points()) {}

  template <typename MakePoint>
  LineCounts run(MakePoint make_point) {
    start(make_point);
    LineCounts counts;
    std::uint64_t step = 0;
    for (std::size_t sample = 1; sample < loop_.samples; ++sample) {
      for (std::size_t inner = loop_.steps_per_sample; inner > 0; --inner) {
        ++step;
        if (!advance(loop_.time_step * static_cast<double>(step))) counts.settled = false;
      }
      store(sample);
      if (loop_.stop.requested()) break;
      if (!counts.settled || !is_finite()) {
        counts.first_bad_sample = sample;
        break;
      }
    }
    for (const Point& point : points_) {
      counts.attachments += point.attachments();
      counts.releases += point.releases();
    }
    return counts;
  }

 private:
  bool implicit() const { return loop_.timing == ForceTiming::kImplicit; }

  BowInstant bow_at(double t) {
    BowInstant bow = cursor_.at(t);
    bow.normal_force = std::max(bow.normal_force, 0.0) / static_cast<double>(size_);
    return bow;
  }

  template <typename MakePoint>
  void start(MakePoint make_point) {
    const BowInstant bow = bow_at(0.0);
    for (std::size_t j = 0; j < size_; ++j) {
      double v = 0.0, y = 0.0;
      for (std::size_t n = 0; n < modes_.size(); ++n) {
        const std::complex<double> z = modes_.initial[n];
        v += modes_.shape[j][n] * (z.real() - modes_.quadrature[n] * z.imag());
        y += modes_.shape[j][n] * modes_.compliance[n] * z.imag();
      }
      points_.push_back(make_point(y, v, bow));
      motion_.velocity[j] = v;
      motion_.displacement[j] = y;
      force_[j] = points_[j].initial_force(bow);
      driving_[j] = implicit() ? force_[j] : 0.0;
    }
    store_start();
    // S holds Z without the newest force.
    for (std::size_t n = 0; n < modes_.size(); ++n) {
      double load = 0.0;
      for (std::size_t j = 0; j < size_; ++j) load += modes_.shape[j][n] * driving_[j];
      const std::complex<double> newest = newer_[n] * (load * modes_.inverse_mass[n]);
      arrays_.state_re[n] -= newest.real();
      arrays_.state_im[n] -= newest.imag();
    }
  }

  // One step to time t; false where the forces of the points do not settle.
  bool advance(double t) {
    HWY_DYNAMIC_DISPATCH(AdvanceLine)(arrays_, driving_, motion_);
    const BowInstant bow = bow_at(t);
    bool settled = true;
    if (implicit()) {
      settled = solve(bow);
      std::copy_n(force_, size_, driving_);
      add_direct();
    } else {
      std::copy_n(force_, size_, driving_);
      add_direct();
      for (std::size_t j = 0; j < size_; ++j) {
        points_[j].begin_step();
        points_[j].switch_state(motion_.velocity[j], motion_.displacement[j], {}, bow);
        force_[j] = points_[j].solve(motion_.velocity[j], motion_.displacement[j], {}, bow);
      }
    }
    for (std::size_t j = 0; j < size_; ++j) {
      points_[j].end_step(loop_.time_step, motion_.velocity[j], force_[j], bow);
      list_switch(j, t);
    }
    return settled;
  }

  void list_switch(std::size_t j, double t) {
    const Switches now{points_[j].attachments(), points_[j].releases()};
    if (now.attachments != counted_[j].attachments) {
      loop_.switches.add({.time = t, .displacement = motion_.displacement[j], .attaches = true});
    }
    if (now.releases != counted_[j].releases) {
      loop_.switches.add({.time = t, .displacement = motion_.displacement[j], .attaches = false});
    }
    counted_[j] = now;
  }

  void add_direct() {
    for (std::size_t j = 0; j < size_; ++j) {
      motion_.velocity[j] += dot(direct_.velocity[j], driving_, size_);
      motion_.displacement[j] += dot(direct_.displacement[j], driving_, size_);
    }
  }

  // Motion of point j that the forces of the others leave, its own force apart.
  struct FreeMotion {
    double velocity, displacement;
    PointResponse own;
  };
  FreeMotion free_motion(std::size_t j) const {
    const PointResponse own{direct_.velocity[j][j], direct_.displacement[j][j]};
    return {
        motion_.velocity[j] + dot(direct_.velocity[j], force_, size_) - own.velocity * force_[j],
        motion_.displacement[j] + dot(direct_.displacement[j], force_, size_) -
            own.displacement * force_[j],
        own};
  }

  // The forces of all points, in states that fit them: all points that must switch under the
  // forces of the others do so together, each once, and the forces are solved for again. Points in
  // equal positions therefore behave equally. False where that leaves a point with a force that
  // friction cannot carry: the step is too long to tell what happened first.
  bool solve(const BowInstant& bow) {
    for (std::size_t j = 0; j < size_; ++j) points_[j].begin_step();
    if (size_ > 1 && !settle(bow)) return false;
    for (std::size_t round = 0; round <= size_; ++round) {
      bool switched = false;
      for (std::size_t j = 0; j < size_; ++j) {
        const FreeMotion free = free_motion(j);
        switched |= points_[j].switch_state(free.velocity, free.displacement, free.own, bow);
      }
      if (size_ > 1 && !switched) break;
      if (!settle(bow)) return false;
      if (size_ == 1) return true;
    }
    return carried(bow);
  }

  bool carried(const BowInstant& bow) const {
    for (std::size_t j = 0; j < size_; ++j) {
      if (!points_[j].carries(force_[j], bow)) return false;
    }
    return true;
  }

  // Gauss–Seidel over the points: a force moves the other points by at most b times it, and b K_a h
  // and b C_a are small where the step resolves the adherence.
  bool settle(const BowInstant& bow) {
    constexpr int kMostSweeps = 200;
    double previous = HUGE_VAL;
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
      double change = 0.0, scale = bow.normal_force;
      for (std::size_t j = 0; j < size_; ++j) {
        const FreeMotion free = free_motion(j);
        const double force = points_[j].solve(free.velocity, free.displacement, free.own, bow);
        change = std::max(change, std::abs(force - force_[j]));
        scale = std::max(scale, std::abs(force));
        force_[j] = force;
      }
      if (size_ == 1 || change <= 1e-13 * scale) return true;
      // The stretch of the spring carries the rounding of the displacement, K_a y · 1e-16: where
      // the changes no longer fall they are that.
      if (change <= 1e-8 * scale && change >= 0.5 * previous) return true;
      if (!std::isfinite(change)) return true;  // reported as a motion that is not finite
      previous = change;
    }
    return false;
  }

  bool is_finite() const {
    for (std::size_t j = 0; j < size_; ++j) {
      if (!std::isfinite(motion_.velocity[j]) || !std::isfinite(force_[j])) return false;
    }
    return true;
  }

  double mean(const double* values) const {
    double sum = 0.0;
    for (std::size_t j = 0; j < size_; ++j) sum += values[j];
    return sum / static_cast<double>(size_);
  }
  void store_contact(std::size_t sample) {
    const SampleTargets& to = loop_.targets;
    if (to.displacement) to.displacement[sample] = mean(motion_.displacement);
    if (to.velocity) to.velocity[sample] = mean(motion_.velocity);
    if (to.force) to.force[sample] = mean(force_) * static_cast<double>(size_);
    for (std::size_t j = 0; j < loop_.point_targets.size(); ++j) {
      loop_.point_targets[j].displacement[sample] = motion_.displacement[j];
      loop_.point_targets[j].velocity[sample] = motion_.velocity[j];
      loop_.point_targets[j].force[sample] = force_[j];
    }
  }
  void store_start() {
    store_contact(0);
    const SampleTargets& to = loop_.targets;
    if (to.left_reaction) to.left_reaction[0] = dot(arrays_.left_gain, arrays_.state_im);
    if (to.right_reaction) to.right_reaction[0] = dot(arrays_.right_gain, arrays_.state_im);
  }
  void store(std::size_t sample) {
    store_contact(sample);
    const SampleTargets& to = loop_.targets;
    if (to.left_reaction) {
      to.left_reaction[sample] =
          dot(arrays_.left_gain, arrays_.state_im) + dot(direct_.left, driving_, size_);
    }
    if (to.right_reaction) {
      to.right_reaction[sample] =
          dot(arrays_.right_gain, arrays_.state_im) + dot(direct_.right, driving_, size_);
    }
  }

  const LineLoop& loop_;
  const LineModes& modes_;
  LineArrays arrays_;
  DirectResponse direct_;
  const std::vector<std::complex<double>>& newer_;
  BowCursor cursor_;
  std::size_t size_;
  std::vector<Point> points_;
  PointMotions motion_{};
  struct Switches {
    std::uint64_t attachments = 0, releases = 0;
  };
  Switches counted_[kMostPoints];  // those that have been listed
  double force_[kMostPoints] = {};
  double driving_[kMostPoints] = {};  // newest forces that Z holds
};

template <typename Law>
LineCounts run_coulomb(const LineLoop& loop, const LineModes& modes, const SchemeWeights& weights,
                       const Law& law, double share) {
  const PointAdherence adherence{share * loop.friction.stiffness, share * loop.friction.damping};
  return Run<CoulombPoint<Law>>(loop, modes, weights)
      .run([&](double y, double v, const BowInstant& bow) {
        return CoulombPoint<Law>(law, adherence, y, v, bow);
      });
}

}  // namespace

LineCounts run_line_loop(const LineLoop& loop, const LineModes& modes,
                         const SchemeWeights& weights) {
  const double share = 1.0 / static_cast<double>(modes.points());
  if (const auto* thermal = std::get_if<ThermalSliding>(&loop.friction.stateful)) {
    return run_coulomb(loop, modes, weights, thermal->share(share), share);
  }
  if (const auto* bristle = std::get_if<BristleFriction>(&loop.friction.stateful)) {
    BristleFriction law = *bristle;
    law.damping = loop.friction.damping;
    law = law.share(share);
    return Run<BristlePoint>(loop, modes, weights)
        .run([&](double /*y*/, double v, const BowInstant& bow) {
          return BristlePoint(law, loop.time_step, v, bow);
        });
  }
  return std::visit([&](const auto& law) { return run_coulomb(loop, modes, weights, law, share); },
                    loop.friction.coefficient);
}

double contact_response(const LineModes& modes, const SchemeWeights& weights) {
  const DirectResponse direct = direct_response(modes, weights);
  double most = 0.0;
  for (std::size_t j = 0; j < modes.points(); ++j) {
    double row = 0.0;
    for (std::size_t i = 0; i < modes.points(); ++i) row += std::abs(direct.velocity[j][i]);
    most = std::max(most, row);
  }
  return most / static_cast<double>(modes.points());
}

double steepest_fall(const LineLoop& loop) {
  if (loop.friction.stateful.index() != 0) return 0.0;
  return loop.bow.normal_force.highest() *
         std::visit([](const auto& law) { return law.steepest_fall(); }, loop.friction.coefficient);
}

}  // namespace modcal
#endif
