// How small errors grow: the relative L2 difference of the contact velocity, window by window,
// between a scene and the same scene with 1e-12 m/s more on every modal velocity at t = 0. Digits
// below it are not the system's.
//
//     perturbation_growth > perturbation_growth.csv
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {
namespace {

constexpr double kRate = 51200.0;
constexpr double kPerturbation = 1e-12;
constexpr std::array kWindowEnds = {0.001, 0.005, 0.02, 0.05, 0.2, 0.5, 1.0};

Simulation run_with(Scene scene, const std::string& rule, double perturbation) {
  // Modes with a node at the contact are no part of the motion.
  for (const double shape : make_modal_basis(scene.string).shape_at(scene.bow.position)) {
    scene.initial.velocity.push_back(is_node(shape) ? 0.0 : perturbation);
    scene.initial.displacement.push_back(0.0);
  }
  return ModalEvent({.max_step = 5e-6, .attach = rule}).simulate(scene, kRate, {.velocity = true});
}

void print_case(const std::string& name, const Scene& scene) {
  for (const std::string rule : {"literal", "continuous"}) {
    const Simulation plain = run_with(scene, rule, 0.0);
    const Simulation moved = run_with(scene, rule, kPerturbation);
    fmt::print("{},{}", name, rule);
    if (plain.diverged_at || moved.diverged_at) {
      fmt::print(",{}{}\n", plain.explanation, moved.explanation);
      continue;
    }
    std::size_t k = 1;  // at t = 0 the difference is the perturbation
    double largest = 0.0;
    for (const double end : kWindowEnds) {
      double error = 0.0, power = 0.0;
      for (; k < static_cast<std::size_t>(end * kRate); ++k) {
        const double difference = moved.velocity.samples[k] - plain.velocity.samples[k];
        error += difference * difference;
        power += plain.velocity.samples[k] * plain.velocity.samples[k];
        largest = std::max(largest, std::abs(difference));
      }
      fmt::print(",{:.1e}", std::sqrt(error / power));
    }
    fmt::print(",{:.1e},{}\n", largest / kPerturbation, plain.attachments + plain.releases);
  }
}

void print_all() {
  fmt::print("case,rule");
  for (const double end : kWindowEnds) fmt::print(",relative difference up to {:g} ms", 1e3 * end);
  fmt::print(",largest amplification,switches\n");
  print_case("paper", paper_scene());
  Scene raucous = paper_scene();
  raucous.bow.position = 0.05;
  raucous.bow.normal_force = 3.0;
  CoulombExponential::Options friction;
  friction.decay = 50.0;
  raucous.friction = Choice<FrictionLaw>::of<CoulombExponential>("coulomb_exponential", friction);
  print_case("raucous (C = 50 s/m; F_N = 3 N; x_c = 50 mm)", raucous);
}

}  // namespace
}  // namespace modcal

int main() { modcal::print_all(); }
