// What is simulated: a string, a bow stroke or a pluck, friction and duration.
#pragma once

#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/gestures/bow.hpp"
#include "libsim/dynamics/scene/scene.hpp"
