#include "libsim/base/trial.hpp"

#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <new>

namespace modcal {
namespace {

void limit(__rlimit_resource resource, rlim_t most) {
  const rlimit value{most, most};
  setrlimit(resource, &value);
}

}  // namespace

bool survives(const std::function<void()>& work, unsigned most_seconds) {
  const pid_t child = fork();
  if (child < 0) throw std::bad_alloc();
  if (child == 0) {
    // A crash is an answer: no core, no handler of somebody's.
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, most_seconds);
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGINT, SIGTERM}) {
      std::signal(signal, SIG_DFL);
    }
    try {
      work();
    } catch (...) {  // The caller hears of it from its own attempt.
    }
    _exit(0);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return false;
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

SharedMemory::SharedMemory(std::size_t bytes)
    : begin_(mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)),
      bytes_(bytes) {
  if (begin_ == MAP_FAILED) throw std::bad_alloc();
}

SharedMemory::~SharedMemory() { munmap(begin_, bytes_); }

}  // namespace modcal
