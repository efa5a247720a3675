// The one way in which independent tasks are spread over threads.
#pragma once

#include <cstddef>
#include <functional>

#include "libsim/base/stop_token.hpp"

namespace modcal {

/// Calls task(i) once for every i in [0, count), over the threads that oneTBB is allowed
/// (tbb::global_control), in any order. What task(i) does must depend on i alone; then results that
/// are kept by i are the same bits for any number of threads.
///
/// A task may run a loop of its own: a thread that waits for it takes part in that loop alone, so
/// that a task once begun is not put off by others of its list.
///
/// Where tasks throw, the exception of the smallest such i is thrown when all tasks before it have
/// ended: the same one whatever the threads; tasks after it may be left out. Throws Interrupted
/// where `stop` was requested; tasks that had not begun are left out then.
void for_each_task(std::size_t count, const std::function<void(std::size_t)>& task,
                   const StopToken& stop = {});

}  // namespace modcal
