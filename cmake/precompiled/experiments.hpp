// JSON, and what the headers of the libraries include of Eigen.
#pragma once

#include <Eigen/Core>

#include "json.hpp"
