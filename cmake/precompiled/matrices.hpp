// The same with Eigen.
#pragma once

#include <Eigen/Dense>

#include "standard.hpp"
