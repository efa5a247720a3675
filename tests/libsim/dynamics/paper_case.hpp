// The paper's simulated case (Debut, Delaune and Antunes, 2010, section 2.3).
#pragma once

#include "libsim/dynamics/scene/scene.hpp"

namespace modcal {

inline Scene paper_scene() {
  Scene scene;
  scene.string.length = 0.33;
  scene.string.linear_density = 3.1e-3;
  scene.string.fundamental = 196.0;
  scene.bow.position = 0.03;
  return scene;
}

}  // namespace modcal
