// How often a program of tests has asked for memory.
#pragma once

#include <cstddef>

namespace modcal {

/// Calls of operator new since the program began, of all threads.
std::size_t allocations();

}  // namespace modcal
