#include "libsim/dynamics/energy/energy_replay.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace modcal {
namespace {

using Complex = std::complex<double>;

constexpr double kLongestQuadrature = 8.0;  // |λ|h

// Z(t + θ) = factor Z + drive (constant f + slope f').
struct Propagator {
  Complex factor, constant, slope;
};

// θ = x/λ, |x| ≤ 1: φ₁ = (eˣ − 1)/x, φ₂ = (eˣ − 1 − x)/x² by their series, 1/22! = 1e-21 left.
Propagator short_propagator(Complex pole, double time) {
  const Complex x = pole * time;
  Complex term = 0.5, second = term;
  for (int j = 1; j <= 20; ++j) {
    term *= x / static_cast<double>(j + 2);
    second += term;
  }
  const Complex first = 1.0 + x * second;
  return {1.0 + x * first, time * first, time * time * second};
}

// v = Re((1 + iκ) Z).
double velocity_of(Complex state, double quadrature) {
  return state.real() - quadrature * state.imag();
}

// A step in parts of |λ|δ ≤ 1, each integrated by Gauss's rule of 6 points.
class QuadratureStep {
 public:
  QuadratureStep(Complex pole, double step, double quadrature)
      : quadrature_(quadrature),
        parts_(std::max(1.0, std::ceil(std::abs(pole) * step))),
        part_(step / parts_),
        whole_(short_propagator(pole, part_)) {
    for (std::size_t i = 0; i < 6; ++i) node_[i] = short_propagator(pole, kNode[i] * part_);
  }

  Complex advance(Complex state, double force, double slope, ModeAccount& account) const {
    for (double p = 0.0; p < parts_; p += 1.0) {
      const double from = force + slope * p * part_;
      for (std::size_t i = 0; i < 6; ++i) {
        const double v = velocity_of(moved(node_[i], state, from, slope), quadrature_);
        account.square += kWeight[i] * part_ * v * v;
        account.work += kWeight[i] * part_ * v * (from + slope * kNode[i] * part_);
      }
      state = moved(whole_, state, from, slope);
    }
    return state;
  }

 private:
  static constexpr std::array<double, 6> kNode = {0.033765242898423986, 0.16939530676686774,
                                                  0.38069040695840155,  0.61930959304159845,
                                                  0.83060469323313226,  0.96623475710157601};
  static constexpr std::array<double, 6> kWeight = {0.085662246189585173, 0.18038078652406930,
                                                    0.23395696728634552,  0.23395696728634552,
                                                    0.18038078652406930,  0.085662246189585173};
  Complex moved(const Propagator& by, Complex state, double force, double slope) const {
    return by.factor * state + by.constant * force + by.slope * slope;
  }

  double quadrature_, parts_, part_;
  Propagator whole_;
  std::array<Propagator, 6> node_;
};

// A step of many radians: v = Re(P e^{λt}) + r₀ + r₁ t, integrated in closed form.
class ClosedStep {
 public:
  ClosedStep(Complex pole, double step, double quadrature)
      : pole_(pole), h_(step), gamma_(1.0, quadrature) {
    factor_ = std::exp(pole * step);
    once_ = (factor_ - 1.0) / pole;
    with_time_ = (step * factor_ - once_) / pole;
    twice_ = (factor_ * factor_ - 1.0) / (2.0 * pole);
    const double decay = 2.0 * pole.real();
    decaying_ = decay == 0.0 ? step : std::expm1(decay * step) / decay;
  }

  Complex advance(Complex state, double force, double slope, ModeAccount& account) const {
    const Complex b = -slope / pole_;
    const Complex a = (b - force) / pole_;
    const Complex p = gamma_ * (state - a);
    const double r0 = (gamma_ * a).real(), r1 = (gamma_ * b).real();
    account.square += 0.5 * std::norm(p) * decaying_ + 0.5 * (p * p * twice_).real() +
                      2.0 * (p * (r0 * once_ + r1 * with_time_)).real() +
                      h_ * (r0 * r0 + h_ * (r0 * r1 + h_ * r1 * r1 / 3.0));
    account.work +=
        (p * (force * once_ + slope * with_time_)).real() +
        h_ * (force * r0 + h_ * (0.5 * (force * r1 + slope * r0) + h_ * slope * r1 / 3.0));
    return (state - a) * factor_ + a + b * h_;
  }

 private:
  Complex pole_;
  double h_;
  Complex gamma_, factor_, once_, with_time_, twice_;
  double decaying_;
};

double energy_of(const ReplayedMode& mode, double v, double y) {
  return 0.5 * (v * v + std::norm(mode.pole) * y * y);
}
double energy_of(const ReplayedMode& mode, Complex state) {
  return energy_of(mode, velocity_of(state, mode.quadrature), mode.compliance * state.imag());
}

template <typename Step>
void replay_linear(const ReplayedMode& mode, std::span<const double> load, double h,
                   std::span<double> velocity, ModeAccount& account) {
  const Step step(mode.pole, h, mode.quadrature);
  Complex state = mode.initial;
  velocity[0] = velocity_of(state, mode.quadrature);
  for (std::size_t k = 0; k + 1 < load.size(); ++k) {
    state = step.advance(state, load[k], (load[k + 1] - load[k]) / h, account);
    velocity[k + 1] = velocity_of(state, mode.quadrature);
  }
  account.end = energy_of(mode, state);
}

void replay_lagged(const ReplayedMode& mode, std::span<const double> load, double h,
                   ModeAccount& account) {
  const double decay = -mode.pole.real() * h;
  const double square = std::norm(mode.pole), quarter = 0.25 * square * h * h;
  double v = velocity_of(mode.initial, mode.quadrature);
  double y = mode.compliance * mode.initial.imag();
  for (std::size_t k = 0; k + 1 < load.size(); ++k) {
    const double push = h * (lagged_force(load, k) - square * y);
    const double next = (v * (1.0 - decay - quarter) + push) / (1.0 + decay + quarter);
    const double mean = 0.5 * (v + next);
    y += h * mean;
    v = next;
    account.square += h * mean * mean;
  }
  account.end = energy_of(mode, v, y);
}

}  // namespace

double lagged_force(std::span<const double> force, std::size_t k) {
  return 0.5 * (force[k] + (k > 0 ? force[k - 1] : 0.0));
}

ModeAccount replay(const ReplayedMode& mode, std::span<const double> load, double step,
                   ForceHold hold, std::span<double> velocity) {
  ModeAccount account{.start = energy_of(mode, mode.initial), .loss_rate = -2.0 * mode.pole.real()};
  if (hold == ForceHold::kLagged) {
    replay_lagged(mode, load, step, account);
  } else if (std::abs(mode.pole) * step > kLongestQuadrature) {
    replay_linear<ClosedStep>(mode, load, step, velocity, account);
  } else {
    replay_linear<QuadratureStep>(mode, load, step, velocity, account);
  }
  return account;
}

}  // namespace modcal
