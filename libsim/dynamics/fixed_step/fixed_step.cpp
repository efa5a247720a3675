#include "libsim/dynamics/fixed_step/fixed_step.hpp"

namespace modcal {
namespace {

struct HoldFunctions {
  std::complex<double> first;   // φ₁(x) = (eˣ − 1)/x
  std::complex<double> second;  // φ₂(x) = (eˣ − 1 − x)/x²
};

HoldFunctions hold_functions(std::complex<double> x) {
  if (std::abs(x) > 1.0) {
    const std::complex<double> first = (std::exp(x) - 1.0) / x;
    return {first, (first - 1.0) / x};
  }
  // φ₂ = Σ x^j/(j + 2)!; 20 terms leave 1/22! ≈ 1e-21 at |x| = 1, where the closed form would
  // cancel like eps/|x|².
  std::complex<double> term = 0.5;
  std::complex<double> second = term;
  for (int j = 1; j <= 20; ++j) {
    term *= x / static_cast<double>(j + 2);
    second += term;
  }
  return {1.0 + x * second, second};
}

// Throws InvalidInput where the force of the steps before, which is all that an explicit scheme
// knows, would feed energy into the contact: the lag turns spring and damper of adherence, and the
// fall of the sliding force with the speed, into an excitation.
//
// The string answers a force within a step h as a mass M = h/(2b). With v_{k+1} = v_k + b (f_k +
// f_{k−1}), y by the trapezoidal rule and f = −K_a y − C_a v, c = b C_a and k = b K_a h/2, the
// held mass obeys
//   λ³ + (c + k − 2) λ² + (1 + 2k) λ + k − c = 0,
// whose roots lie inside the unit circle where |k − c| < 1 and c (1 − c) > k (2 − c) (Jury, 1964);
// at critical damping that is h √(K_a/M) < 3 − √5.
void require_stable_adherence(const ContactParameters& contact, double response, double time_step) {
  const double c = response * contact.damping;
  const double k = 0.5 * response * contact.stiffness * time_step;
  MODCAL_REQUIRE(std::abs(k - c) < 1.0 && c * (1.0 - c) > k * (2.0 - c),
                 "time step {:g} s is too long for an explicit scheme with adherence of {:g} N/m "
                 "and {:g} N s/m: the contact would create energy; take a shorter step, a softer "
                 "or nearly critically damped adherence, or modal_exact or modal_event",
                 time_step, contact.stiffness, contact.damping);
}

// Throws InvalidInput where the scheme cannot take the step; `response` is b, of the velocity to
// the newest force [m/(N s)]. With the force solved for, v = v_free + b F(v) needs a single
// solution, b |F'| < 1; an explicit force is asked for half of that.
void require_step(const FixedStepRun& run, const GeneralContact& contact, double response) {
  const double force = contact.bow.normal_force.highest();
  const bool is_explicit = run.timing == ForceTiming::kPreviousStep;
  if (is_explicit) {
    if (!(contact.friction.static_limit(force) > 0.0)) return;
    require_stable_adherence(contact.parameters, response, run.time_step);
  }
  // A law with a state does not follow the speed at once.
  if (contact.friction.has_state()) return;
  const double fall = std::visit([](const auto& law) { return law.steepest_fall(); },
                                 contact.friction.sliding(force));
  const double slope_number = fall * response, largest = is_explicit ? 0.5 : 1.0;
  MODCAL_REQUIRE(slope_number < largest,
                 "time step {:g} s is too long for {}this friction law: its force falls by {:g} N "
                 "per m/s, which needs a step below about {:g} s",
                 run.time_step, is_explicit ? "an explicit scheme with " : "", fall,
                 largest * run.time_step / slope_number);
}

// The fast loop, where it can take the scene: one point, a steady bow, a law of the sliding speed.
std::optional<LoopCounts> run_plain(const Scene& scene, const FixedStepRun& run,
                                    GeneralContact contact, WeightsOfPole weights_of_pole,
                                    Simulation& result) {
  if (scene.bow.points != 1 || scene.bow.width != 0.0 || !contact.bow.is_steady() ||
      contact.friction.has_state()) {
    return std::nullopt;
  }
  const ContactModes modes = scene_modes(scene);
  const SchemeWeights weights = scheme_weights(modes, run.time_step, weights_of_pole);
  if (!are_separable(weights)) return std::nullopt;
  contact.parameters = contact_parameters(contact.bow, contact.friction, modes.effective_mass());
  MotionSample start = motion_of(modes, modes.initial);
  const SteadyContact steady{.parameters = contact.parameters,
                             .law = contact.friction.sliding(contact.bow.normal_force.at(0.0)),
                             .initial_displacement = start.displacement,
                             .initial_velocity = start.velocity};
  start.force = initial_force(steady);
  // The explicit scheme has no force before t = 0; the implicit one starts with that of t = 0.
  StepCoefficients coefficients = make_step_coefficients(
      modes, weights, run.timing == ForceTiming::kImplicit ? start.force : 0.0);
  require_step(run, contact, coefficients.direct_response.velocity);
  run.targets.write(0, start);
  result.modes_moved = modes.size();
  return run_step_loop(run, steady, coefficients);
}

LoopCounts run_general(const Scene& scene, FixedStepRun& run, GeneralContact contact,
                       WeightsOfPole weights_of_pole, Simulation& result,
                       std::vector<PointMotion>* points) {
  const LineModes modes = scene_line_modes(scene);
  const SchemeWeights weights = scheme_weights(modes, run.time_step, weights_of_pole);
  contact.parameters = contact_parameters(contact.bow, contact.friction, modes.effective_mass());
  require_step(run, contact, contact_response(modes, weights));
  if (points != nullptr) {
    points->assign(modes.points(), PointMotion(run.samples));
    for (PointMotion& point : *points) {
      run.point_targets.push_back({.displacement = point.displacement.data(),
                                   .velocity = point.velocity.data(),
                                   .force = point.force.data()});
    }
  }
  result.modes_moved = modes.size();
  return run_line_loop(run, contact, modes, weights);
}

}  // namespace

ModeWeights first_order_hold_weights(std::complex<double> pole, double time_step) {
  const std::complex<double> x = pole * time_step;
  const HoldFunctions hold = hold_functions(x);
  return {.propagate = std::exp(x),
          .older = time_step * (hold.first - hold.second),
          .newer = time_step * hold.second};
}

ModeWeights trapezoidal_weights(std::complex<double> pole, double time_step) {
  const std::complex<double> half = 0.5 * time_step * pole;
  const std::complex<double> weight = 0.5 * time_step / (1.0 - half);
  return {.propagate = (1.0 + half) / (1.0 - half), .older = weight, .newer = weight};
}

SchemeWeights scheme_weights(const ModeTable& modes, double time_step, WeightsOfPole weights) {
  SchemeWeights result;
  for (const auto& pole : modes.pole) result.push_back(weights(pole, time_step));
  return result;
}

void FixedStepOptions::visit(OptionVisitor& visitor) {
  visitor("time_step",
          "largest time step; the next smaller one that divides the sampling "
          "period is taken",
          {.unit = "s", .range = Range::positive()}, time_step);
}

Simulation simulate_fixed_step(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                               const StopToken& stop, double wanted_time_step,
                               const FixedStepScheme& scheme, std::vector<PointMotion>* points) {
  const BowMotion bow = bow_motion(scene.bow, scene.duration);
  const auto friction = scene.friction.make();
  const StepPlan plan = plan_steps(wanted_time_step, sample_rate);
  const std::size_t count = sample_count(scene.duration, sample_rate);
  Simulation result = empty_simulation(count, sample_rate, outputs);
  FixedStepRun run{.timing = scheme.timing,
                   .time_step = plan.time_step,
                   .steps_per_sample = plan.steps_per_sample,
                   .samples = count,
                   .targets = targets_of(result),
                   .point_targets = {},
                   .switches = {&result.switches, outputs.switches_from},
                   .stop = stop};
  const GeneralContact contact{{}, *friction, bow};
  std::optional<LoopCounts> counts;
  if (points == nullptr) counts = run_plain(scene, run, contact, scheme.weights, result);
  if (!counts) counts = run_general(scene, run, contact, scheme.weights, result, points);

  if (counts->first_bad_sample < count) {
    result.diverge(static_cast<double>(counts->first_bad_sample) / sample_rate,
                   counts->settled ? "the motion is not a finite number"
                                   : "the forces of the contact points do not settle within a "
                                     "step: use a smaller time step");
  }
  result.time_step = plan.time_step;
  result.steps = (count - 1) * plan.steps_per_sample;
  result.attachments = counts->attachments;
  result.releases = counts->releases;
  return result;
}

}  // namespace modcal
