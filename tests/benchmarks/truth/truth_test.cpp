// The string that modcal is compared with: that it is the string it says it is.
#include "benchmarks/truth/truth.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <stdexcept>

#include "benchmarks/truth/bridge.hpp"
#include "benchmarks/truth/decimator.hpp"
#include "benchmarks/truth/sensor.hpp"
#include "tests/benchmarks/truth/continuum.hpp"

namespace modcal::truth::truth_test {
namespace {

/// Small and quick, with a bow that excites it well.
TruthOptions quick(double duration) {
  return {.duration = duration, .least_rate = 2e6, .audit = true};
}

// Reactions

/// x_c(L − x_c)/(L T) − sinh λx_c sinh λ(L − x_c)/(λT sinh λL), λ = √(T/EI), far from the ends
/// [m/N].
double compliance(const TruthString& string, double position) {
  const double tension = string.tension(), lambda = std::sqrt(tension / string.bending());
  return position * (string.length - position) / (string.length * tension) -
         0.5 / (lambda * tension);
}

TEST(TruthRecord, SharesAStaticForceBetweenItsEnds) {
  TruthString string;
  string.loss = 1500.0;  // at rest 25 ms later, to 1e-16
  TruthGesture gesture{.position = 0.0413,
                       .action = TruthForce{.force = {{0.0, 0.0}, {0.01, 0.7}}}};
  for (const Reactions kind : {Reactions::kTension, Reactions::kSupport}) {
    TruthOptions options = quick(0.002);
    options.start = 0.036;
    options.reactions = kind;
    const TruthRecord record = simulate(string, gesture, options);
    const double near = 1.0 - gesture.position / string.length;
    EXPECT_NEAR(record.r1.back(), -0.7 * near, 1e-9);
    EXPECT_NEAR(record.r2.back(), -0.7 * (1.0 - near), 1e-9);
    EXPECT_NEAR(record.r1.back() + record.r2.back(), -0.7, 1e-10);
    EXPECT_NEAR(record.f.back(), 0.7, 1e-12);
    // Modes beyond the grid do not bend.
    EXPECT_NEAR(record.y.back() / (0.7 * compliance(string, gesture.position)), 1.0, 6e-4);
  }
}

/// Σ x_i exp(−s t_i), the Laplace transform but for the sample interval.
std::complex<double> transform(const TruthRecord& record, const std::vector<double>& x,
                               std::complex<double> s) {
  const std::complex<double> turn = std::exp(-s / record.rate);
  std::complex<double> sum = 0.0, phase = 1.0;
  for (std::size_t i = 0; i < x.size(); ++i, phase *= turn) sum += phase * x[i];
  return sum;
}

/// R1, R2 and y per force of the continuum, all its modes.
struct Transfer {
  std::complex<double> r1, r2, y;
};
Transfer transfer(const TruthString& string, double position, Reactions kind,
                  std::complex<double> s) {
  Transfer sum{};
  for (std::size_t n = 1; n <= 20000; ++n) {
    const double wavenumber = static_cast<double>(n) * kPi / string.length;
    const double omega = 2.0 * kPi * frequency(string, n);
    double gain = string.tension() * wavenumber;
    if (kind == Reactions::kSupport) gain += string.bending() * std::pow(wavenumber, 3);
    const double shape = std::sin(wavenumber * position);
    const std::complex<double> answer = 2.0 / (string.linear_density * string.length) * shape /
                                        (omega * omega + s * s + 2.0 * decay(string, n) * s);
    sum.r1 -= gain * answer;
    sum.r2 += (n % 2 == 0 ? 1.0 : -1.0) * gain * answer;
    sum.y += shape * answer;
  }
  return sum;
}

/// The same of a string on a bridge: y = w + u x/L, w with the load f δ − ρ (x/L) s² u.
Transfer transfer(const TruthString& string, double position, const TruthMismatch& bridge,
                  std::complex<double> s) {
  const double length = string.length, tension = string.tension();
  const double omega = 2.0 * kPi * bridge.body_frequency;
  const Transfer pinned = transfer(string, position, Reactions::kTension, s);
  const Transfer support = transfer(string, position, Reactions::kSupport, s);
  std::complex<double> stiffness =
      bridge.bridge_mass * (s * s + 2.0 * bridge.body_damping * omega * s + omega * omega) +
      tension / length;
  Transfer chord{-tension / length, tension / length, position / length};
  for (std::size_t n = 1; n <= 20000; ++n) {
    const double wavenumber = static_cast<double>(n) * kPi / length;
    const double own = 2.0 * kPi * frequency(string, n), even = n % 2 == 0 ? 1.0 : -1.0;
    const std::complex<double> answer = even * 2.0 / (wavenumber * length) * s * s /
                                        (own * own + s * s + 2.0 * decay(string, n) * s);
    chord.r1 -= tension * wavenumber * answer;
    chord.r2 += even * tension * wavenumber * answer;
    chord.y += std::sin(wavenumber * position) * answer;
    stiffness +=
        even * (tension * wavenumber + string.bending() * std::pow(wavenumber, 3)) * answer;
  }
  const std::complex<double> u = -support.r2 / stiffness;
  return {pinned.r1 + chord.r1 * u, pinned.r2 + chord.r2 * u, pinned.y + chord.y * u};
}

TEST(TruthRecord, AnswersAForceAsTheContinuumDoes) {
  // A short force on a heavily damped string.
  TruthString string;
  string.loss = 600.0;
  const TruthGesture gesture{.position = 0.0413,
                             .action = TruthForce{.force = {{0.0, 0.0}, {4e-5, 1.0}, {8e-5, 0.0}}}};
  for (const Reactions kind : {Reactions::kTension, Reactions::kSupport}) {
    TruthOptions options{.duration = 0.06, .reactions = kind};
    const TruthRecord record = simulate(string, gesture, options);
    for (const double f : {100.0, 450.0, 2000.0, 9000.0, 16000.0}) {
      const std::complex<double> s(0.0, 2.0 * kPi * f), force = transform(record, record.f, s);
      const Transfer expected = transfer(string, gesture.position, kind, s);
      const double bound = f < 10e3 ? 2e-4 : 1e-3;
      EXPECT_LT(std::abs(transform(record, record.r1, s) / force / expected.r1 - 1.0), bound) << f;
      EXPECT_LT(std::abs(transform(record, record.r2, s) / force / expected.r2 - 1.0), bound) << f;
      // What the contact's own compliance lacks of modes beyond the grid stays the same at all f.
      const double missing = 6e-4 * compliance(string, gesture.position);
      EXPECT_LT(std::abs(transform(record, record.y, s) / force - expected.y), missing) << f;
      EXPECT_LT(std::abs(transform(record, record.v, s) / force / s - expected.y), missing) << f;
    }
  }
}

TEST(TruthRecord, MovesItsBridgeAsTheContinuumDoes) {
  // A light bridge, that much of the answer is its.
  TruthString string;
  string.loss = 600.0;
  const TruthMismatch bridge{.body_frequency = 430.0, .body_damping = 0.2, .bridge_mass = 2e-3};
  const TruthGesture gesture{.position = 0.0413,
                             .action = TruthForce{.force = {{0.0, 0.0}, {4e-5, 1.0}, {8e-5, 0.0}}}};
  const TruthRecord record = simulate(string, gesture, {.duration = 0.06, .mismatch = bridge});
  for (const double f : {100.0, 300.0, 430.0, 2000.0, 9000.0}) {
    const std::complex<double> s(0.0, 2.0 * kPi * f), force = transform(record, record.f, s);
    const Transfer expected = transfer(string, gesture.position, bridge, s);
    EXPECT_LT(std::abs(transform(record, record.r1, s) / force / expected.r1 - 1.0), 2e-4) << f;
    EXPECT_LT(std::abs(transform(record, record.r2, s) / force / expected.r2 - 1.0), 2e-4) << f;
    const double missing = 6e-4 * compliance(string, gesture.position);
    EXPECT_LT(std::abs(transform(record, record.y, s) / force - expected.y), missing) << f;
  }
  const Transfer rigid =
      transfer(string, gesture.position, Reactions::kTension, {0.0, 2.0 * kPi * 430.0});
  const Transfer moving = transfer(string, gesture.position, bridge, {0.0, 2.0 * kPi * 430.0});
  EXPECT_GT(std::abs(moving.r1 / rigid.r1 - 1.0), 0.02);
}

// Without stiffness and losses T k cot kL + m (ω_r² − ω²) = 0, k = ω/c. The sum over the modes
// lacks those beyond the grid, some 10⁻⁶ of what the bridge does.
TEST(TruthRecord, KnowsTheModesOfAStringOnABridge) {
  const TruthString string{.inharmonicity = 0.0, .loss = 0.0, .diffusion = 0.0};
  const TruthMismatch bridge{.body_frequency = 430.0, .body_damping = 0.0, .bridge_mass = 0.05};
  const double speed = string.wave_speed(), body = 2.0 * kPi * 430.0;
  std::vector<WaveMode> pinned;
  for (std::size_t n = 1; n < 400; ++n) {
    pinned.push_back({.omega = 2.0 * kPi * string.fundamental * static_cast<double>(n)});
  }
  const std::vector<WaveMode> modes =
      Bridge(string, bridge, {.intervals = 400, .time_step = 1e-7}).coupled(pinned);
  for (std::size_t n = 0; n < 10; ++n) {
    const auto balance = [&](double omega) {
      const double k = omega / speed;
      return string.tension() * k / std::tan(k * string.length) +
             bridge.bridge_mass * (body * body - omega * omega);
    };
    const double moved = modes[n].omega / pinned[n].omega - 1.0;
    EXPECT_GT(std::abs(moved), 1e-6) << n;
    EXPECT_NEAR(modes[n].decay, 0.0, 1e-9);
    // The zero lies between 1e-3 less and more of what the bridge has moved it.
    EXPECT_LT(balance(pinned[n].omega * (1.0 + 0.999 * moved)) *
                  balance(pinned[n].omega * (1.0 + 1.001 * moved)),
              0.0)
        << n;
  }
}

TEST(TruthRecord, ObeysTheContinuumWhileItIsBowed) {
  // Weighted by exp(−σt) a record that goes on at its end lacks e^{−σT}. What is left is the answer
  // of one time step, of order (ωk)².
  TruthString turning;
  turning.torsion.emplace();
  const TruthBow exponential, thermal{.friction = ThermalFriction{}};
  const TruthOptions options{.duration = 0.15, .least_rate = 4e6};
  const double sigma = 20.0 / options.duration;
  for (const auto& [string, bow] :
       {std::pair<TruthString, TruthBow>{{}, exponential}, {{}, thermal}, {turning, exponential}}) {
    const TruthGesture gesture{.position = 0.0431, .action = bow};
    const TruthRecord record = simulate(string, gesture, options);
    EXPECT_GT(record.slips, 40u);
    double f = 150.0;
    while (f < 22e3) {
      const std::complex<double> s(sigma, 2.0 * kPi * f), force = transform(record, record.f, s);
      const Transfer expected = transfer(string, gesture.position, Reactions::kTension, s);
      const double size =
          std::abs(force) * std::hypot(std::abs(expected.r1), std::abs(expected.r2));
      const double bound = (3e-4 * std::pow(f / 20e3, 2.0) + 1e-7) * size;
      EXPECT_LT(std::abs(transform(record, record.r1, s) - expected.r1 * force), bound) << f;
      EXPECT_LT(std::abs(transform(record, record.r2, s) - expected.r2 * force), bound) << f;
      f *= 1.13;
    }
  }
}

// Contact and energy

void expect_sound(const TruthRecord& record) {
  EXPECT_LT(std::abs(record.audit.residual()), 1e-9);
  EXPECT_LT(record.audit.friction_violation, 1e-9);
  EXPECT_GE(record.audit.least_heat_power, -1e-9);
  EXPECT_GT(record.audit.lost, 0.0);
}

TEST(TruthRecord, BalancesEnergyAndStaysInTheFrictionSet) {
  TruthGesture gesture;
  TruthBow bow{.velocity = {{0.0, 0.05}, {0.03, 0.15}}, .normal_force = {{0.0, 0.6}, {0.06, 0.3}}};
  gesture.action = bow;
  const TruthRecord exponential = simulate({}, gesture, quick(0.06));
  expect_sound(exponential);
  EXPECT_GT(exponential.stuck, 0.3);
  EXPECT_GT(exponential.slips, 15u);

  bow.friction = ThermalFriction{};
  gesture.action = bow;
  const TruthRecord thermal = simulate({}, gesture, quick(0.06));
  expect_sound(thermal);
  EXPECT_GT(thermal.stuck, 0.3);
  EXPECT_LT(thermal.stuck, 1.0);

  TruthString turning;
  turning.torsion.emplace();
  expect_sound(simulate(turning, gesture, quick(0.06)));

  gesture.action = TruthPluck{};
  expect_sound(simulate({}, gesture, quick(0.06)));
  gesture.action = TruthForce{};
  expect_sound(simulate({}, gesture, quick(0.06)));
}

TEST(TruthContact, SolvesLoadLineAndFrictionTogether) {
  const ExponentialFriction law{
      .static_coefficient = 0.6, .dynamic_coefficient = 0.2, .decay = 8.0};
  Contact contact(law, 1e-7);
  ContactState state = contact.solve(
      {.free_velocity = 0.1, .mobility = 0.05, .bow_velocity = 0.11, .normal_force = 1.0});
  EXPECT_TRUE(state.stuck);
  EXPECT_NEAR(state.force, 0.01 / 0.05, 1e-15);
  for (const double free : {-1.0, 1.3}) {
    state = contact.solve(
        {.free_velocity = free, .mobility = 0.05, .bow_velocity = 0.1, .normal_force = 1.0});
    EXPECT_FALSE(state.stuck);
    EXPECT_NEAR(free - 0.1 + 0.05 * state.force, state.slip, 1e-14);
    EXPECT_NEAR(state.force,
                -std::copysign(0.2 + 0.4 * std::exp(-8.0 * std::abs(state.slip)), free), 1e-14);
  }
  EXPECT_THROW(
      contact.solve(
          {.free_velocity = 10.0, .mobility = 5.0, .bow_velocity = 0.0, .normal_force = 1.0}),
      std::invalid_argument);
}

TEST(TruthContact, WarmsByItsOwnWorkAndSoftens) {
  // Held at one sliding speed: ϑ → |f u|/(G + S u).
  const ThermalFriction law;
  Contact contact(law, 1e-5);
  ContactState state;
  for (int i = 0; i < 20000; ++i) {
    state = contact.solve(
        {.free_velocity = 0.2, .mobility = 1e-9, .bow_velocity = 0.0, .normal_force = 0.5});
  }
  const double rise =
      std::abs(state.force * state.slip) / (law.conductance + law.carried_heat * 0.2);
  EXPECT_NEAR(contact.temperature() / rise, 1.0, 1e-6);
  EXPECT_LT(std::abs(state.force), 0.5 * law.cold_coefficient);
  EXPECT_GT(std::abs(state.force), 0.5 * law.hot_coefficient);
}

// Mismatch

TEST(TruthSensor, AnswersAsItsFormulaSays) {
  const double rate = 1e6;
  const TruthSensor::Numbers numbers{.gain = 1.02,
                                     .delay = 3.3e-6,
                                     .corner = 5.0,
                                     .body_peak = 0.0125,
                                     .body_frequency = 280.0,
                                     .body_damping = 0.02};
  for (const double f : {20.0, 275.0, 280.0, 2000.0, 9000.0}) {
    TruthSensor sensor(numbers, rate);
    std::complex<double> sum = 0.0;
    for (std::size_t i = 0; i < 1200000; ++i) {
      // Ten periods of 20 Hz or more, half a second after the start.
      const double phase = 2.0 * kPi * f * static_cast<double>(i) / rate;
      const double read = sensor.read(std::cos(phase));
      if (i >= 700000) sum += read * std::polar(2.0 / 500000.0, -phase);
    }
    const std::complex<double> s(0.0, 2.0 * kPi * f);
    const double omega = 2.0 * kPi * 280.0;
    const std::complex<double> body =
        0.0125 * 2.0 * 0.02 * omega * s / (s * s + 2.0 * 0.02 * omega * s + omega * omega);
    const std::complex<double> expected =
        1.02 * std::exp(-3.3e-6 * s) * s / (s + 2.0 * kPi * 5.0) * (1.0 + body);
    // The delay between two samples is linear: (ω/rate)²/8; and the start has decayed to e^{−22}.
    EXPECT_LT(std::abs(sum - expected), 5e-4 * std::pow(f / 9000.0, 2.0) + 1e-6) << f;
  }
  EXPECT_THROW(TruthSensor({.gain = 1.0, .delay = -1e-6}, rate), std::invalid_argument);
}

TEST(TruthMismatch, AddsASecondPolarization) {
  const TruthGesture gesture{.action = TruthForce{.force = {{0.0, 0.0}, {1e-3, 0.3}, {2e-3, 0.0}}}};
  TruthOptions options{.duration = 0.01, .least_rate = 2e6};
  const TruthRecord clean = simulate({}, gesture, options);
  options.mismatch.polarization[0] = 0.1;
  options.mismatch.polarization[1] = 0.2;
  options.mismatch.detuning = 0.0;
  const TruthRecord mixed = simulate({}, gesture, options);
  for (std::size_t i = 0; i < clean.r1.size(); ++i) {
    EXPECT_NEAR(mixed.r1[i], 1.1 * clean.r1[i], 1e-12);
    EXPECT_NEAR(mixed.r2[i], 1.2 * clean.r2[i], 1e-12);
  }
  options.mismatch.detuning = 1.3e-3;
  EXPECT_NE(simulate({}, gesture, options).r1, mixed.r1);
}

// Filter, noise, refusals

TEST(TruthDecimator, IsFlatAndDark) {
  for (const std::size_t factor : {200u, 232u}) {
    for (const double f : {0.0, 0.01, 0.2, 0.44, 0.45, 0.55, 0.7, 1.0, 1.5, 7.3, 50.0}) {
      Decimator decimator(factor, true);
      const double turn = 2.0 * kPi * f / static_cast<double>(factor);
      for (std::size_t i = 0; i < 400 * factor; ++i) {
        decimator.push(std::cos(turn * static_cast<double>(i)));
      }
      double worst = 0.0;
      for (std::size_t i = 150; i < 300; ++i) {
        const double exact =
            f <= Decimator::kPass ? std::cos(2.0 * kPi * f * static_cast<double>(i)) : 0.0;
        worst = std::max(worst, std::abs(decimator.samples()[i] - exact));
      }
      EXPECT_LT(worst, Decimator::kRipple) << factor << ' ' << f;
    }
  }
}

TEST(TruthRecord, AddsTheNoiseItStates) {
  TruthRecord record{.r1 = std::vector<double>(20000), .r2 = std::vector<double>(20000)};
  for (std::size_t i = 0; i < 20000; ++i) {
    record.r1[i] = 3.0 + std::sin(0.1 * static_cast<double>(i));
    record.r2[i] = i % 2 == 0 ? 2.0 : -2.0;
  }
  const TruthRecord clean = record;
  add_noise(record, 0.05, 7);
  EXPECT_NEAR(record.noise[0], 0.05 * std::sqrt(0.5), 1e-4);
  EXPECT_DOUBLE_EQ(record.noise[1], 0.1);
  double square = 0.0, cross = 0.0;
  for (std::size_t i = 0; i < 20000; ++i) {
    const double a = record.r1[i] - clean.r1[i], b = record.r2[i] - clean.r2[i];
    square += b * b;
    cross += a * b;
  }
  EXPECT_NEAR(std::sqrt(square / 20000.0), 0.1, 0.0025);  // five deviations
  EXPECT_NEAR(cross / 20000.0 / (record.noise[0] * record.noise[1]), 0.0, 0.035);
}

TEST(TruthRecord, RefusesWhatItCannotSimulate) {
  EXPECT_THROW(simulate({}, {.position = 0.001}, quick(0.01)), std::invalid_argument);
  EXPECT_THROW(simulate({.length = -1.0}, {}, quick(0.01)), std::invalid_argument);
  EXPECT_THROW(simulate({}, {}, {.duration = 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace modcal::truth::truth_test
