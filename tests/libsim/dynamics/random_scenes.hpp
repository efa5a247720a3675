// Scenes drawn at random over the ranges a calibration may meet.
#pragma once

#include <array>
#include <cmath>

#include "libsim/base/random.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/model/damping.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {

/// The paper's string with force 0.05…5 N, speed 0.005…0.5 m/s of either sign, x_c L/200…L/2,
/// C 1…100 s/m, K_a 1e4…1e6 N/m, ζ 1e-4…1e-2, B 1e-6…1e-4: two decades, all logarithmic.
inline Scene random_scene(std::uint64_t seed) {
  std::array<double, 8> u{};
  fill_uniform(StreamKey(seed).with("random scene"), u);
  const auto logarithmic = [&u](std::size_t i, double low, double high) {
    return low * std::pow(high / low, u[i]);
  };
  Scene scene = paper_scene();
  scene.bow.normal_force = logarithmic(0, 0.05, 5.0);
  scene.bow.velocity = logarithmic(1, 0.005, 0.5) * (u[7] < 0.5 ? -1.0 : 1.0);
  scene.bow.position = logarithmic(2, 1.65e-3, 0.165);
  scene.string.inharmonicity = logarithmic(6, 1e-6, 1e-4);
  scene.string.damping = Choice<DampingLaw>::of<ConstantDamping>(
      "constant", ConstantDamping::Options{logarithmic(5, 1e-4, 1e-2)});
  CoulombExponential::Options friction;
  friction.decay = logarithmic(3, 1.0, 100.0);
  friction.adherence.stiffness = logarithmic(4, 1e4, 1e6);
  scene.friction = Choice<FrictionLaw>::of<CoulombExponential>("coulomb_exponential", friction);
  return scene;
}

}  // namespace modcal
