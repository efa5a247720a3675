// The modal model: poles, sensors and contacts of a structure, and the string that makes one.
#pragma once

#include "libsim/model/modal_basis.hpp"
#include "libsim/model/transfer.hpp"
