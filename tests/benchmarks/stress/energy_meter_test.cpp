#include "benchmarks/stress/energy_meter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/gestures/gesture.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"
#include "libsim/dynamics/scene/scene.hpp"
#include "libsim/model/damping.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::energy_meter_test {
namespace {

constexpr double kRate = 51200.0;

AuditedRun audited(const Scene& scene, const ModalEvent::Options& options = {}) {
  return simulate_audited(ModalEvent(options), scene, kRate, OutputRequest::all());
}

Scene short_scene(double duration) {
  Scene scene = paper_scene();
  scene.duration = duration;
  return scene;
}

void expect_closed(const EventEnergy& energy, const std::string& what) {
  EXPECT_LE(std::abs(energy.string_residual()), energy.string_bound()) << what;
  EXPECT_LE(std::abs(energy.contact_residual()), energy.contact_bound()) << what;
  EXPECT_LT(energy.string_bound(), 1e-9 * energy.string_at_hand()) << what;
  EXPECT_GT(energy.dissipated, 0.0) << what;
  EXPECT_GE(energy.friction, 0.0) << what;
  EXPECT_GE(energy.damper, 0.0) << what;
}

// The string's balance is open by rounding only: 1e4 pieces of 1 to 2 radians of the fastest mode
// err by 2⁻⁵² each, at random. What the force between the nodes misses of the law is below 1e-5 of
// its work on every step (defect), and with the signs of Lobatto's rule its square.
TEST(EnergyMeter, ClosesOnThePapersCase) {
  for (const char* rule : {"literal", "continuous"}) {
    const auto [run, energy] = audited(short_scene(0.1), {.attach = rule});
    ASSERT_FALSE(run.diverged_at);
    expect_closed(energy, rule);
    EXPECT_LT(std::abs(energy.string_residual()), 1e-12 * energy.bow_work) << rule;
    EXPECT_LT(std::abs(energy.contact_residual()), 1e-8 * energy.bow_work) << rule;
    EXPECT_LT(energy.defect, 1e-5 * energy.bow_work) << rule;
    EXPECT_GT(energy.friction, 0.5 * energy.bow_work);
    EXPECT_GT(energy.dropped, 1e-3 * energy.bow_work);
    EXPECT_EQ(energy.wound > 0.0, std::string(rule) == "continuous");
  }
}

// The force polynomial through s nodes misses h^s of the law, and ∫ of that times v_c h^{2(s−1)},
// as Lobatto's rule is exact to degree 2s − 3. Steps at which the residual is above rounding; the
// steps cut by switches do not halve with the others, which leaves 0.3.
TEST(EnergyMeter, FallsWithTheOrder) {
  const auto at = [](std::int64_t nodes, double step) {
    const ModalEvent::Options options{
        .nodes = nodes, .max_step = step, .slope_number = 0.35 * step / 2e-5, .tail_ratio = 1e3};
    return audited(short_scene(0.02), options).energy;
  };
  for (const std::int64_t nodes : {2, 3, 4, 5}) {
    const EventEnergy coarse = at(nodes, 5e-6), fine = at(nodes, 2.5e-6);
    const auto order = static_cast<double>(nodes);
    EXPECT_NEAR(std::log2(coarse.defect / fine.defect), order, 0.3) << nodes;
    EXPECT_LT(std::abs(coarse.string_residual()), coarse.string_bound());
    if (nodes > 3) continue;
    EXPECT_NEAR(std::log2(coarse.contact_residual() / fine.contact_residual()), 2.0 * (order - 1.0),
                0.3)
        << nodes;
  }
}

TEST(EnergyMeter, LeavesTheRunAsItIs) {
  const Scene scene = short_scene(0.05);
  const Simulation plain = ModalEvent({}).simulate(scene, kRate, OutputRequest::all());
  const Simulation watched = audited(scene).simulation;
  EXPECT_EQ(plain.velocity.samples, watched.velocity.samples);
  EXPECT_EQ(plain.force.samples, watched.force.samples);
  EXPECT_EQ(plain.right_reaction.samples, watched.right_reaction.samples);
}

Choice<Gesture> table(std::vector<double> times, std::vector<double> factors) {
  return Choice<Gesture>::of<TableGesture>(
      "table", TableGesture::Options{std::move(times), std::move(factors)});
}

// Whatever the bow does and the contact is made of: reversals, a lift, noise, a pluck, torsion,
// heat, no contact at all, steps of many radians.
TEST(EnergyMeter, ClosesWhateverTheBowAndTheContactDo) {
  std::vector<Scene> scenes(8, short_scene(0.03));
  scenes[0].bow.velocity_gesture = table({0.01, 0.02}, {1.0, -1.0});
  scenes[1].bow.force_gesture = table({0.006, 0.008, 0.012, 0.014}, {1.0, 0.0, 0.0, 1.0});
  scenes[2].torsion.present = true;
  scenes[3].friction = Choice<FrictionLaw>("thermal");
  scenes[4].friction = Choice<FrictionLaw>("hyperbolic");
  scenes[5].start = Choice<InitialMotion>::of<Pluck>("pluck", Pluck::Options{0.07, 1e-3});
  scenes[6].bow.velocity_noise = {.present = true, .level = 0.02, .cutoff = 400.0, .seed = 3};
  scenes[7].start = scenes[5].start;
  scenes[7].bow.normal_force = 0.0;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    for (const double step : {1.0 / kRate, 0.5e-3}) {
      const auto [run, energy] =
          simulate_audited(ModalEvent({}), scenes[i], 1.0 / step, OutputRequest::all());
      ASSERT_FALSE(run.diverged_at) << run.explanation;
      expect_closed(energy, std::to_string(i));
      EXPECT_LE(energy.contact_bound() + energy.heat_residual, 1e-4 * energy.contact_at_hand())
          << i;
    }
  }
}

// A free decay loses what it stored: E(0) (1 − e^{−2ζωt}) after whole periods of the one mode.
TEST(EnergyMeter, OfAFreeDecayIsTheClosedForm) {
  Scene scene = paper_scene();
  scene.string.modes = 1;
  scene.string.damping =
      Choice<DampingLaw>::of<ConstantDamping>("constant", ConstantDamping::Options{0.01});
  scene.bow.normal_force = 0.0;
  scene.initial.displacement = {1e-3};
  scene.initial.velocity = {0.0};
  const ModalBasis basis = make_modal_basis(scene.string);
  const double damped = basis.omega[0] * std::sqrt(1.0 - 1e-4);
  const double period = 2.0 * 3.141592653589793 / damped;
  scene.duration = 51.0 * period / 10.0;  // samples at 0 … 5 periods
  const EventEnergy energy =
      simulate_audited(ModalEvent({}), scene, 10.0 / period, OutputRequest::all()).energy;
  const double start = 0.5 * basis.mass[0] * std::pow(basis.omega[0] * 1e-3, 2);
  const double left = std::exp(-2.0 * 0.01 * basis.omega[0] * 5.0 * period);
  EXPECT_NEAR(energy.stored, start * (left - 1.0), 1e-13 * start);
  EXPECT_NEAR(energy.dissipated, start * (1.0 - left), 1e-13 * start);
  EXPECT_EQ(energy.bow_work, 0.0);
}

// Passes a run on to a meter, wrongly.
class WrongObserver final : public event::ForceObserver {
 public:
  enum class Error { kNone, kSkippedPiece, kForgottenSpring, kWoundSpring, kLongerPiece };
  WrongObserver(event::EnergyMeter& meter, Error error) : meter_(meter), error_(error) {}
  void piece(const event::ForcePiece& piece) override {
    const bool here = ++pieces_ == 700;
    if (here && error_ == Error::kSkippedPiece) return;
    event::ForcePiece changed = piece;
    if (here && error_ == Error::kLongerPiece) changed.duration *= 1.0 + 1e-6;
    meter_.piece(changed);
  }
  void attached(double elongation) override {
    meter_.attached(error_ == Error::kWoundSpring ? elongation + 1e-9 : elongation);
  }
  void released() override {
    const bool forgets = error_ == Error::kForgottenSpring && ++releases_ == 5;
    if (!forgets) meter_.released();
  }

 private:
  event::EnergyMeter& meter_;
  Error error_;
  int pieces_ = 0, releases_ = 0;
};

// The paper's case, run as ModalEvent runs it.
struct Watched {
  ContactModes modes;
  event::EventLoop loop;
  event::EventState state;
  explicit Watched(const Scene& scene) : modes(scene_modes(scene)) {
    const BowMotion bow = bow_motion(scene.bow, scene.duration);
    const auto friction = scene.friction.make();
    loop.contact = contact_parameters(bow, *friction, modes.effective_mass());
    loop.law = friction->sliding(bow.normal_force.at(0.0));
    loop.grid_step = 1.0 / kRate;
    loop.samples = sample_count(scene.duration, kRate);
    state = event::initial_state(modes, bow.velocity.at(0.0));
  }
  // What a meter that believes in other modes or another contact makes of the run.
  EventEnergy measured(const event::EventLoop& believed, const ContactModes& believed_modes,
                       WrongObserver::Error error = WrongObserver::Error::kNone) {
    event::EnergyMeter meter(believed, believed_modes, state);
    WrongObserver observer(meter, error);
    event::EventLoop run = loop;
    run.observer = &observer;
    event::EventState end = state;
    EXPECT_FALSE(run_event_loop(run, modes, end).failure);
    return meter.account(end);
  }
};

bool string_is_open(const EventEnergy& energy) {
  return std::abs(energy.string_residual()) > energy.string_bound();
}

TEST(EnergyMeter, SeesWrongDissipation) {
  Watched watched(short_scene(0.03));
  const EventEnergy right = watched.measured(watched.loop, watched.modes);
  EXPECT_FALSE(string_is_open(right));
  // One mode of 50 that decays by 1e-6 less than it should.
  ContactModes damped = watched.modes;
  damped.pole[3] -= 1e-6 * std::abs(damped.pole[3].real());
  EXPECT_TRUE(string_is_open(watched.measured(watched.loop, damped)));
}

// A friction law or damper that is off by 1e-4 shows as a defect of that size.
TEST(EnergyMeter, SeesAForceThatTheLawDoesNotGive) {
  Watched watched(short_scene(0.03));
  const EventEnergy right = watched.measured(watched.loop, watched.modes);
  event::EventLoop believed = watched.loop;
  std::get<ExponentialSliding>(believed.law).dynamic_force *= 1.0001;
  const EventEnergy sliding = watched.measured(believed, watched.modes);
  EXPECT_GT(std::abs(sliding.contact_residual()), 1e-5 * sliding.bow_work);
  EXPECT_GT(sliding.defect, 10.0 * right.contact_bound());
  believed = watched.loop;
  believed.contact.damping *= 1.0001;
  const EventEnergy held = watched.measured(believed, watched.modes);
  EXPECT_NEAR(held.contact_residual() - right.contact_residual(), -1e-4 * right.damper,
              1e-10 * right.damper);
  EXPECT_GT(held.defect, 10.0 * std::abs(right.contact_residual()));
}

TEST(EnergyMeter, SeesWrongJumps) {
  using Error = WrongObserver::Error;
  Watched watched(short_scene(0.03));
  const EventEnergy right = watched.measured(watched.loop, watched.modes);
  const auto contact_is_open = [&](const EventEnergy& energy) {
    return std::abs(energy.contact_residual()) > 10.0 * right.contact_bound();
  };
  EXPECT_FALSE(contact_is_open(right));
  const auto with = [&](Error error) {
    return watched.measured(watched.loop, watched.modes, error);
  };
  EXPECT_TRUE(contact_is_open(with(Error::kForgottenSpring)));
  EXPECT_TRUE(contact_is_open(with(Error::kWoundSpring)));
  EXPECT_TRUE(string_is_open(with(Error::kSkippedPiece)));
  EXPECT_TRUE(string_is_open(with(Error::kLongerPiece)));
}

}  // namespace
}  // namespace modcal::energy_meter_test
