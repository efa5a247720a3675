// How a fit learns that somebody wants it to end.
#pragma once

#include <functional>

namespace modcal {

/// Called before every evaluation; what it throws (Interrupted, say) ends the fit and comes out of
/// it. Empty: nobody can ask.
using FitPoll = std::function<void()>;

}  // namespace modcal
