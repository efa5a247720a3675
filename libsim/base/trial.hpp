// Libraries that crash on damaged files, in a process of their own.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

namespace modcal {

/// Whether work() returns in a child of this process, which ends with it: not where it crashes or
/// takes more than `most_seconds` of processor time. What it throws and changes is lost. One thread
/// at a time may use what work() uses.
bool survives(const std::function<void()>& work, unsigned most_seconds);

/// Memory that this process and its children see alike, all zeros.
class SharedMemory {
 public:
  /// Throws std::bad_alloc.
  explicit SharedMemory(std::size_t bytes);
  ~SharedMemory();
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;
  template <typename T>
  std::span<T> as() const {
    return {static_cast<T*>(begin_), bytes_ / sizeof(T)};
  }

 private:
  void* begin_;
  std::size_t bytes_;
};

}  // namespace modcal
