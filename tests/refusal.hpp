// What a call says that is refused.
#pragma once

#include <string>

#include "libsim/base/error.hpp"

namespace modcal {

/// Message of the InvalidInput that call() throws; "accepted" where it throws none.
template <typename Call>
std::string refusal_of(Call call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace modcal
