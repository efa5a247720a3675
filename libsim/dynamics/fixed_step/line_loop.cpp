
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
  Run(const FixedStepRun& run, const BowMotion& bow, const LineModes& modes,
      const SchemeWeights& weights)
      : run_(run),
        modes_(modes),
        arrays_(make_line_arrays(modes, weights)),
        direct_(direct_response(modes, weights)),
        weights_(weights),
        cursor_(bow),
        size_(modes.points()),
        forces_(direct_) {}

  template <typename MakePoint>
  LoopCounts run(MakePoint make_point) {
    start(make_point);
    LoopCounts counts;
    std::uint64_t step = 0;
    for (std::size_t sample = 1; sample < run_.samples; ++sample) {
      for (std::size_t inner = run_.steps_per_sample; inner > 0; --inner) {
        ++step;
        if (!advance(run_.time_step * static_cast<double>(step))) counts.settled = false;
      }
      store(sample);
      if (run_.stop.requested()) break;
      run_.stop.tell(sample, run_.samples);
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
  bool implicit() const { return run_.timing == ForceTiming::kImplicit; }

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
    store(0);
    // S holds Z without the newest force.
    for (std::size_t n = 0; n < modes_.size(); ++n) {
      double load = 0.0;
      for (std::size_t j = 0; j < size_; ++j) load += modes_.shape[j][n] * driving_[j];
      const std::complex<double> newest = weights_[n].newer * (load * modes_.inverse_mass[n]);
      arrays_.state.re[n] -= newest.real();
      arrays_.state.im[n] -= newest.imag();
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
    forces_.end_step(run_.time_step, motion_, bow);
    for (std::size_t j = 0; j < size_; ++j) list_switch(j, t);
    return settled;
  }

  void list_switch(std::size_t j, double t) {
    const Switches now{forces_.points()[j].attachments(), forces_.points()[j].releases()};
    if (now.attachments != counted_[j].attachments) {
      run_.switches.add({.time = t, .displacement = motion_.displacement[j], .attaches = true});
    }
    if (now.releases != counted_[j].releases) {
      run_.switches.add({.time = t, .displacement = motion_.displacement[j], .attaches = false});
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
  // At t = 0 S still holds all of Z.
  void store(std::size_t sample) {
    const SampleTargets& to = run_.targets;
    const auto reaction = [&](const double* wanted, const PlanarVector& gain,
                              const double* direct) {
      if (wanted == nullptr) return 0.0;
      const double sum =
          sum_of_products(gain.im, arrays_.state.im) + sum_of_products(gain.re, arrays_.state.re);
      return sample == 0 ? sum : sum + dot(direct, driving_, size_);
    };
    to.write(sample, {.displacement = mean(motion_.displacement),
                      .velocity = mean(motion_.velocity),
                      .force = mean(forces_.force()) * static_cast<double>(size_),
                      .left = reaction(to.left_reaction, arrays_.left_gain, direct_.left),
                      .right = reaction(to.right_reaction, arrays_.right_gain, direct_.right)});
    for (std::size_t j = 0; j < run_.point_targets.size(); ++j) {
      run_.point_targets[j].write(sample, {.displacement = motion_.displacement[j],
                                           .velocity = motion_.velocity[j],
                                           .force = forces_.force()[j]});
    }
  }

  const FixedStepRun& run_;
  const LineModes& modes_;
  LineArrays arrays_;
  DirectResponse direct_;
  const SchemeWeights& weights_;
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

}  // namespace

LoopCounts run_line_loop(const FixedStepRun& run, const GeneralContact& contact,
                         const LineModes& modes, const SchemeWeights& weights) {
  const double share = 1.0 / static_cast<double>(modes.points());
  const ContactParameters& whole = contact.parameters;
  const auto run_coulomb = [&](const auto& law) {
    using Point = CoulombPoint<std::decay_t<decltype(law)>>;
    const PointAdherence adherence{share * whole.stiffness, share * whole.damping};
    return Run<Point>(run, contact.bow, modes, weights)
        .run([&](double y, double v, const BowInstant& bow) {
          return Point(law, adherence, y, v, bow);
        });
  };
  const StatefulLaw& stateful = contact.friction.stateful();
  if (const auto* thermal = std::get_if<ThermalSliding>(&stateful)) {
    return run_coulomb(thermal->share(share));
  }
  if (const auto* bristle = std::get_if<BristleFriction>(&stateful)) {
    BristleFriction law = *bristle;
    law.damping = whole.damping;
    law = law.share(share);
    return Run<BristlePoint>(run, contact.bow, modes, weights)
        .run([&](double /*y*/, double v, const BowInstant& bow) {
          return BristlePoint(law, run.time_step, v, bow);
        });
  }
  return std::visit(run_coulomb, contact.friction.sliding(1.0));
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

}  // namespace modcal
