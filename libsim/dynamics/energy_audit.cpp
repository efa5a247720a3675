#include "libsim/dynamics/energy_audit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using Complex = std::complex<double>;

constexpr double kEpsilon = 2.220446049250313e-16;
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

struct ModeAccount {
  double work = 0.0, square = 0.0;  // ∫ f v dt, ∫ v² dt
};

// v = Re((1 + iκ) Z).
double velocity_of(Complex state, double quadrature) {
  return state.real() - quadrature * state.imag();
}

// A step in parts of |λ|δ ≤ 1, each integrated by Gauss's rule of 6 points.
class QuadratureStep {
 public:
  QuadratureStep(Complex pole, double step, double drive, double quadrature)
      : drive_(drive),
        quadrature_(quadrature),
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
    return by.factor * state + drive_ * (by.constant * force + by.slope * slope);
  }

  double drive_, quadrature_, parts_, part_;
  Propagator whole_;
  std::array<Propagator, 6> node_;
};

// A step of many radians: v = Re(P e^{λt}) + r₀ + r₁ t, integrated in closed form.
class ClosedStep {
 public:
  ClosedStep(Complex pole, double step, double drive, double quadrature)
      : pole_(pole), h_(step), drive_(drive), gamma_(1.0, quadrature) {
    factor_ = std::exp(pole * step);
    once_ = (factor_ - 1.0) / pole;
    with_time_ = (step * factor_ - once_) / pole;
    twice_ = (factor_ * factor_ - 1.0) / (2.0 * pole);
    const double decay = 2.0 * pole.real();
    decaying_ = decay == 0.0 ? step : std::expm1(decay * step) / decay;
  }

  Complex advance(Complex state, double force, double slope, ModeAccount& account) const {
    const Complex b = -drive_ * slope / pole_;
    const Complex a = (b - drive_ * force) / pole_;
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
  double h_, drive_;
  Complex gamma_, factor_, once_, with_time_, twice_;
  double decaying_;
};

struct Record {
  const std::vector<double>&y, &v, &f;
  double step;
};

double energy_of(const ContactModes& modes, std::size_t n, double v, double y) {
  return 0.5 * (v * v + std::norm(modes.pole[n]) * y * y) / modes.drive[n];
}
double loss_rate(const ContactModes& modes, std::size_t n) {
  return -2.0 * modes.pole[n].real() / modes.drive[n];
}

void add_energies(EnergyAccount& account, double before, double after, double& start, double& end) {
  account.stored += after - before;
  start += before;
  end += after;
}

template <typename Step>
void replay_linear(const ContactModes& modes, std::size_t n, const Record& record,
                   EnergyAccount& account, double& start, double& end,
                   std::vector<double>& velocity) {
  const double quadrature = modes.quadrature[n];
  const Step step(modes.pole[n], record.step, modes.drive[n], quadrature);
  Complex state = modes.initial[n];
  const double first_v = velocity_of(state, quadrature);
  const double before = energy_of(modes, n, first_v, modes.compliance[n] * state.imag());
  velocity[0] += first_v;
  ModeAccount mode;
  for (std::size_t k = 0; k + 1 < record.f.size(); ++k) {
    const double slope = (record.f[k + 1] - record.f[k]) / record.step;
    state = step.advance(state, record.f[k], slope, mode);
    velocity[k + 1] += velocity_of(state, quadrature);
  }
  const double after =
      energy_of(modes, n, velocity_of(state, quadrature), modes.compliance[n] * state.imag());
  account.string_work += mode.work;
  account.dissipated += loss_rate(modes, n) * mode.square;
  add_energies(account, before, after, start, end);
}

// Mean force of step k + 1, which ends with sample k + 1; no force is known before t = 0.
double lagged_force(const Record& record, std::size_t k) {
  return 0.5 * (record.f[k] + (k > 0 ? record.f[k - 1] : 0.0));
}

void replay_lagged(const ContactModes& modes, std::size_t n, const Record& record,
                   EnergyAccount& account, double& start, double& end) {
  const double h = record.step, decay = -modes.pole[n].real() * h;
  const double square = std::norm(modes.pole[n]), quarter = 0.25 * square * h * h;
  const double initial = modes.initial[n].imag();
  double v = velocity_of(modes.initial[n], modes.quadrature[n]), y = modes.compliance[n] * initial;
  const double before = energy_of(modes, n, v, y);
  double integral = 0.0;
  for (std::size_t k = 0; k + 1 < record.f.size(); ++k) {
    const double push = h * (modes.drive[n] * lagged_force(record, k) - square * y);
    const double next = (v * (1.0 - decay - quarter) + push) / (1.0 + decay + quarter);
    const double mean = 0.5 * (v + next);
    y += h * mean;
    v = next;
    integral += h * mean * mean;
  }
  account.dissipated += loss_rate(modes, n) * integral;
  add_energies(account, before, energy_of(modes, n, v, y), start, end);
}

// What the samples say themselves: works of the step and magnitudes.
void account_contact(const Record& record, double bow_velocity, ForceHold hold,
                     const std::vector<double>& replayed, EnergyAccount& account) {
  const double h = record.step;
  for (std::size_t k = 0; k + 1 < record.f.size(); ++k) {
    double force = 0.0, velocity = 0.0;
    if (hold == ForceHold::kLagged) {
      force = lagged_force(record, k);
      velocity = (record.y[k + 1] - record.y[k]) / h;
      account.string_work += force * velocity * h;
    } else {
      force = 0.5 * (record.f[k] + record.f[k + 1]);
      velocity = 0.5 * (record.v[k] + record.v[k + 1]);
      // The replayed modes have done the work under their own velocity: the rest is the
      // simulator's.
      account.string_work += force * h * (velocity - 0.5 * (replayed[k] + replayed[k + 1]));
    }
    account.bow_work += force * bow_velocity * h;
    account.throughput += std::abs(force * velocity) * h;
    account.contact_throughput += std::abs(force * (velocity - bow_velocity)) * h;
  }
  account.contact_loss = account.bow_work - account.string_work;
}

double largest(const std::vector<double>& values) {
  double result = 0.0;
  for (const double value : values) result = std::max(result, std::abs(value));
  return result;
}

double interpolation_bound(const ContactModes& modes, const Record& record, double fastest) {
  double bends = 0.0, mobility = 0.0;
  for (std::size_t k = 1; k + 1 < record.f.size(); ++k) {
    bends += std::abs(record.f[k + 1] - 2.0 * record.f[k] + record.f[k - 1]);
  }
  for (std::size_t n = 0; n < modes.size(); ++n) mobility += modes.drive[n] * modes.compliance[n];
  // Samples further apart than a radian of the fastest mode say nothing of what is between them.
  if (fastest > 1.0) bends += 2.0 * largest(record.f) * static_cast<double>(record.f.size());
  return bends * record.step * (largest(record.v) + largest(record.f) * mobility);
}

}  // namespace

EnergyAccount audit_energy(const ContactModes& modes, const Simulation& run, double bow_velocity,
                           ForceHold hold) {
  const std::size_t count = run.force.size();
  MODCAL_REQUIRE(count > 0 && run.displacement.size() == count && run.velocity.size() == count,
                 "an energy account needs displacement, velocity and force, but they have {}, {} "
                 "and {} samples: ask the simulator for all three",
                 run.displacement.size(), run.velocity.size(), count);
  const Record record{run.displacement.samples, run.velocity.samples, run.force.samples,
                      1.0 / run.force.sample_rate};
  EnergyAccount account;
  std::vector<double> replayed(hold == ForceHold::kLagged ? 0 : count);
  double start = 0.0, end = 0.0, fastest = 0.0;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const double radians = std::abs(modes.pole[n]) * record.step;
    fastest = std::max(fastest, radians);
    if (hold == ForceHold::kLagged) {
      replay_lagged(modes, n, record, account, start, end);
    } else if (radians > kLongestQuadrature) {
      replay_linear<ClosedStep>(modes, n, record, account, start, end, replayed);
    } else {
      replay_linear<QuadratureStep>(modes, n, record, account, start, end, replayed);
    }
  }
  account_contact(record, bow_velocity, hold, replayed, account);
  account.largest_stored = std::max(start, end);
  account.rounding = 4.0 * kEpsilon * static_cast<double>(count) * (1.0 + fastest) *
                         (account.throughput + account.dissipated + account.largest_stored) +
                     1e-12 * (account.throughput + account.dissipated);
  if (hold == ForceHold::kSampled) {
    account.interpolation = interpolation_bound(modes, record, fastest);
  }
  return account;
}

}  // namespace modcal
