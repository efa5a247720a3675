// The same with Eigen and the test library.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "matrices.hpp"
