// The same with Eigen.
#pragma once

#include <Eigen/Dense>

#include "libsim/base/dense_solvers.hpp"
#include "standard.hpp"
