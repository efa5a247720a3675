#include "libinverse/observer/observer_kernel.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libinverse/observer/steady_gain.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/libinverse/observer/bowed_record.hpp"

namespace modcal::observer::observer_kernel_test {
namespace {

struct Observed {
  std::vector<double> left_innovation, right_innovation, force, velocity, displacement;
};

BlendedSliding papers_sliding() { return {.dynamic_force = 0.2, .force_drop = 0.2, .decay = 5.0}; }

// Thermal friction with its default numbers.
BlendedSliding thermal_sliding() {
  const Thermal::Options law;
  BlendedSliding sliding{.dynamic_force = law.hot_coefficient,
                         .force_drop = law.cold_coefficient - law.hot_coefficient,
                         .thermal = true};
  sliding.heating = 1.0 / (law.heat_capacity * law.softening_rise);
  sliding.cooling = law.conductance / law.heat_capacity;
  sliding.carried = law.carried_heat / law.heat_capacity;
  sliding.width = law.softening_width / law.softening_rise;
  return sliding;
}

ContactLaw contact_with(const BlendedSliding& sliding, const StringTables& string) {
  ContactLaw contact;
  contact.sliding = sliding;
  contact.stiffness = 1e5;
  contact.damping = 2.0 * std::sqrt(contact.stiffness * string.effective_mass);
  return contact;
}

Observed run(const BowedRecord& record, Substeps substeps, const GainTable* gain,
             std::size_t samples, std::size_t block,
             const BlendedSliding& sliding = papers_sliding()) {
  const StringTables string =
      make_string_tables(record.basis, record.scene.bow.position, kRecordRate, substeps);
  const GainTable none{PlanarVector(string.mode.size()), PlanarVector(string.mode.size())};
  const std::vector<double> scale(samples, 1.0), bow(samples, record.scene.bow.velocity);
  Observed out;
  for (auto* signal : {&out.left_innovation, &out.right_innovation, &out.force, &out.velocity,
                       &out.displacement}) {
    signal->resize(samples);
  }
  const ObserverSignals signals{
      {record.truth.left_reaction.samples.data(), record.truth.right_reaction.samples.data()},
      scale.data(),
      bow.data(),
      {out.left_innovation.data(), out.right_innovation.data()},
      out.force.data(),
      out.velocity.data(),
      out.displacement.data()};
  const ContactLaw contact = contact_with(sliding, string);
  ObserverState state = ObserverState::at_rest(string.size());
  state.force = contact.sliding.at(bow[0]).force;
  for (std::size_t first = 0; first < samples; first += block) {
    run_observer(string, contact, gain ? *gain : none, signals, first,
                 std::min(samples, first + block), state);
  }
  return out;
}

double error_of(const std::vector<double>& x, const Signal& truth, std::size_t samples) {
  return relative_rms_error(std::span(x).first(samples), std::span(truth.samples).first(samples));
}

// Without correction the observer is a simulator: against the event-driven one, whose error is 1e-6
// here, its error falls with the step. Order 2 between switches; 40 switches in 20 ms.
TEST(ObserverKernel, WithoutGainItSimulatesTheScene) {
  const BowedRecord record = bowed_record(0.03, 0.0);
  const std::size_t samples = 1024;
  double previous = 1.0;
  for (const std::size_t coarse : {5, 10, 20}) {
    const Observed r = run(record, {coarse, 16}, nullptr, samples, samples);
    const double error = error_of(r.velocity, record.truth.velocity, samples);
    EXPECT_LT(error, 0.5 * previous) << coarse;
    previous = error;
    EXPECT_LT(error_of(r.displacement, record.truth.displacement, samples), 0.01);
  }
  EXPECT_LT(previous, 2e-3);
}

// The same with friction that follows the temperature, against the fixed-step simulator: its
// switches stand on a grid of 0.2 µs, the observer's temperature is of first order.
TEST(ObserverKernel, WithoutGainItSimulatesThermalFriction) {
  BowedRecord record = bowed_record(0.012, 0.0);
  record.scene.friction.select("thermal");
  ModalExact::Options fine;
  fine.time_step = 2e-7;
  record.truth = ModalExact(fine).simulate(record.scene, kRecordRate, OutputRequest::all());
  const std::size_t samples = 512;
  const Observed r = run(record, {20, 16}, nullptr, samples, samples, thermal_sliding());
  EXPECT_LT(error_of(r.velocity, record.truth.velocity, samples), 0.05);
  EXPECT_GT(correlation(r.force, std::span(record.truth.force.samples).first(samples)), 0.99);
}

TEST(ObserverKernel, WithTrueParametersItFollowsCleanData) {
  const BowedRecord record = bowed_record(0.2, 0.0);
  const std::size_t samples = record.truth.force.size();
  const double noise[2] = {0.01 * standard_deviation(record.truth.left_reaction.samples),
                           0.01 * standard_deviation(record.truth.right_reaction.samples)};
  const SteadyGain gain =
      steady_gain(record.basis, record.scene.bow.position, kRecordRate, 1e-3, noise);
  const Observed r = run(record, {10, 16}, &gain.gain, samples, samples);
  EXPECT_GT(correlation(r.velocity, record.truth.velocity.samples), 0.99999);
  // A jump put on the wrong side of one sample costs up to 0.4 N there, rms 0.035 N · 0.11 of
  // 10 240 samples: correlation 0.994 with one of them. The median does not see it.
  EXPECT_GT(correlation(r.force, record.truth.force.samples), 0.99);
  std::vector<double> error(samples);
  for (std::size_t k = 0; k < samples; ++k) {
    error[k] = std::abs(r.force[k] - record.truth.force.samples[k]);
  }
  EXPECT_LT(quantile(error, 0.5), 1e-4);
  EXPECT_LT(standard_deviation(r.left_innovation), 0.05 * noise[0]);
}

// A contact that slides as fast as the bow has come to rest on it: nothing moves, and no force
// does.
TEST(ObserverKernel, AStringAtRestUnderABowAtRestSticks) {
  BowedRecord record = bowed_record(0.003, 0.0);
  record.scene.bow.velocity = 0.0;
  for (Signal* reaction : {&record.truth.left_reaction, &record.truth.right_reaction}) {
    std::ranges::fill(reaction->samples, 0.0);
  }
  const Observed r = run(record, {10, 16}, nullptr, 100, 100);
  for (std::size_t k = 0; k < 100; ++k) {
    EXPECT_EQ(r.force[k], 0.0) << k;
    EXPECT_EQ(r.velocity[k], 0.0) << k;
  }
}

// The state holds everything: blocks give the bits of one run.
TEST(ObserverKernel, BlocksContinueTheRun) {
  const BowedRecord record = bowed_record(0.03, 0.0);
  const double noise[2] = {1e-3, 1e-3};
  const SteadyGain gain =
      steady_gain(record.basis, record.scene.bow.position, kRecordRate, 1e-2, noise);
  const std::size_t samples = record.truth.force.size();
  const Observed whole = run(record, {5, 8}, &gain.gain, samples, samples);
  const Observed pieces = run(record, {5, 8}, &gain.gain, samples, 7);
  EXPECT_EQ(whole.force, pieces.force);
  EXPECT_EQ(whole.left_innovation, pieces.left_innovation);
  EXPECT_EQ(whole.displacement, pieces.displacement);
}

// More than 56 modes: the state does not fit into registers and stays in memory.
TEST(ObserverKernel, ManyModesStayInMemory) {
  BowedRecord record = bowed_record(0.02, 0.0);
  record.scene.string.modes = 90;
  record.basis = make_modal_basis(record.scene.string);
  record.truth = ModalEvent({}).simulate(record.scene, kRecordRate, OutputRequest::all());
  const std::size_t samples = 512;
  const Observed r = run(record, {20, 16}, nullptr, samples, samples);
  EXPECT_LT(error_of(r.velocity, record.truth.velocity, samples), 5e-3);
}

}  // namespace
}  // namespace modcal::observer::observer_kernel_test
