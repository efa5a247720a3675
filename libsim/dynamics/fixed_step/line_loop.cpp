#include "libsim/dynamics/fixed_step/line_loop.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/dynamics/fixed_step/point_forces.hpp"

namespace modcal {
namespace {

double sum_of_products(const AlignedVector& a, const AlignedVector& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

template <typename Point>
class Run {
 public:
  Run(const LineLoop& loop, const LineModes& modes, const SchemeWeights& weights)
      : loop_(loop),
        modes_(modes),
        arrays_(make_line_arrays(modes, weights)),
        direct_(direct_response(modes, weights)),
        newer_(weights.newer),
        cursor_(loop.bow),
        size_(modes.points()),
        forces_(direct_) {}

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
    for (const Point& point : forces_.points()) {
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
      forces_.add(make_point(y, v, bow), bow);
      motion_.velocity[j] = v;
      motion_.displacement[j] = y;
      driving_[j] = implicit() ? forces_.force()[j] : 0.0;
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
    advance_line(arrays_, driving_, motion_);
    const BowInstant bow = bow_at(t);
    bool settled = true;
    if (implicit()) settled = forces_.solve(motion_, bow);
    std::copy_n(forces_.force(), size_, driving_);
    add_direct();
    if (!implicit()) forces_.follow(motion_, bow);
    forces_.end_step(loop_.time_step, motion_, bow);
    for (std::size_t j = 0; j < size_; ++j) list_switch(j, t);
    return settled;
  }

  void list_switch(std::size_t j, double t) {
    const Switches now{forces_.points()[j].attachments(), forces_.points()[j].releases()};
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

  bool is_finite() const {
    for (std::size_t j = 0; j < size_; ++j) {
      if (!std::isfinite(motion_.velocity[j]) || !std::isfinite(forces_.force()[j])) return false;
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
    if (to.force) to.force[sample] = mean(forces_.force()) * static_cast<double>(size_);
    for (std::size_t j = 0; j < loop_.point_targets.size(); ++j) {
      loop_.point_targets[j].displacement[sample] = motion_.displacement[j];
      loop_.point_targets[j].velocity[sample] = motion_.velocity[j];
      loop_.point_targets[j].force[sample] = forces_.force()[j];
    }
  }
  void store_start() {
    store_contact(0);
    const SampleTargets& to = loop_.targets;
    if (to.left_reaction)
      to.left_reaction[0] = sum_of_products(arrays_.left_gain, arrays_.state_im);
    if (to.right_reaction)
      to.right_reaction[0] = sum_of_products(arrays_.right_gain, arrays_.state_im);
  }
  void store(std::size_t sample) {
    store_contact(sample);
    const SampleTargets& to = loop_.targets;
    if (to.left_reaction) {
      to.left_reaction[sample] =
          sum_of_products(arrays_.left_gain, arrays_.state_im) + dot(direct_.left, driving_, size_);
    }
    if (to.right_reaction) {
      to.right_reaction[sample] = sum_of_products(arrays_.right_gain, arrays_.state_im) +
                                  dot(direct_.right, driving_, size_);
    }
  }

  const LineLoop& loop_;
  const LineModes& modes_;
  LineArrays arrays_;
  DirectResponse direct_;
  const std::vector<std::complex<double>>& newer_;
  BowCursor cursor_;
  std::size_t size_;
  PointForces<Point> forces_;
  PointMotions motion_{};
  struct Switches {
    std::uint64_t attachments = 0, releases = 0;
  };
  Switches counted_[kMostPoints];     // those that have been listed
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
