#include "benchmarks/stress/stress_cell.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/gestures/gesture.hpp"
#include "libsim/dynamics/scene/scene.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {
namespace {

// Through these factors at the given shares of the record.
Choice<Gesture> table(double duration, std::vector<double> shares, std::vector<double> factors) {
  for (double& share : shares) share *= duration;
  return Choice<Gesture>::of<TableGesture>(
      "table", TableGesture::Options{std::move(shares), std::move(factors)});
}

// Strokes that turn round five times. A table: the pieces of a sine depend on the record's length.
Choice<Gesture> strokes(double duration) {
  return table(duration, {0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0},
               {0.0, 1.0, -1.0, 1.0, -1.0, 1.0, 0.0});
}

Choice<InitialMotion> pluck(double displacement) {
  Pluck::Options options;
  options.position = 0.07;
  options.displacement = displacement;
  return Choice<InitialMotion>::of<Pluck>("pluck", options);
}

NamedScene named(std::string name, void (*change)(Scene&, double), double duration) {
  NamedScene result{std::move(name), paper_scene()};
  change(result.scene, duration);
  return result;
}

void set_noise(Scene& scene, double duration) {
  for (GestureNoise* noise : {&scene.bow.velocity_noise, &scene.bow.force_noise}) {
    noise->present = true;
    noise->level = 0.1;
    noise->cutoff = 20.0 / duration;
  }
}

void set_wide(Scene& scene) {
  scene.bow.width = 5e-3;
  scene.bow.points = 3;
}

}  // namespace

std::vector<NamedScene> moving_bows(double duration) {
  const auto scene = [duration](std::string name, void (*change)(Scene&, double)) {
    return named(std::move(name), change, duration);
  };
  return {
      scene("reversing",
            [](Scene& s, double t) {
              s.bow.velocity_gesture = table(t, {0.0, 0.4, 0.6}, {1.0, 1.0, -1.0});
            }),
      scene("strokes", [](Scene& s, double t) { s.bow.velocity_gesture = strokes(t); }),
      scene("10 m/s strokes",
            [](Scene& s, double t) {
              s.bow.velocity = 10.0;
              s.bow.velocity_gesture = strokes(t);
            }),
      scene("lifted",
            [](Scene& s, double t) {
              s.bow.force_gesture = table(t, {0.3, 0.4}, {1.0, 0.0});
            }),
      scene("lifted, put back",
            [](Scene& s, double t) {
              s.bow.force_gesture = table(t, {0.3, 0.4, 0.6, 0.7}, {1.0, 0.0, 0.0, 1.0});
            }),
      scene("noisy", set_noise),
      scene("pluck", [](Scene& s, double) { s.start = pluck(2e-3); }),
      scene("pluck 1e-310 m", [](Scene& s, double) { s.start = pluck(1e-310); }),
  };
}

std::vector<NamedScene> other_contacts(double duration) {
  const auto scene = [duration](std::string name, void (*change)(Scene&, double)) {
    return named(std::move(name), change, duration);
  };
  return {
      scene("hyperbolic", [](Scene& s, double) { s.friction = Choice<FrictionLaw>("hyperbolic"); }),
      scene("thermal", [](Scene& s, double) { s.friction = Choice<FrictionLaw>("thermal"); }),
      scene("elasto-plastic",
            [](Scene& s, double) { s.friction = Choice<FrictionLaw>("elasto_plastic"); }),
      scene("LuGre",
            [](Scene& s, double) {
              ElastoPlastic::Options options;
              options.model = "lugre";
              s.friction = Choice<FrictionLaw>::of<ElastoPlastic>("elasto_plastic", options);
            }),
      scene("torsion", [](Scene& s, double) { s.torsion.present = true; }),
      scene("5 mm wide", [](Scene& s, double) { set_wide(s); }),
      scene("wide, strokes",
            [](Scene& s, double t) {
              set_wide(s);
              s.bow.velocity_gesture = strokes(t);
            }),
      scene("all of it",
            [](Scene& s, double t) {
              set_wide(s);
              s.bow.velocity_gesture = strokes(t);
              s.torsion.present = true;
              s.friction = Choice<FrictionLaw>("thermal");
              s.start = pluck(1e-3);
            }),
  };
}

}  // namespace modcal
