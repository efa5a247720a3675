// Options as one line of text that is equal for equal options: the key of what is computed once.
#pragma once

#include <exception>
#include <future>
#include <map>
#include <mutex>

#include "libsim/base/options.hpp"

namespace modcal {

/// Keys and values in the order of the visit; numbers bit for bit.
std::string fingerprint(const std::function<void(OptionVisitor&)>& visit_options);

// What many tasks need and one computes.

/// Values by their keys, each computed once. Safe to use from several threads: who asks for a value
/// that is being computed waits for it; where it cannot be computed everybody gets the exception.
template <typename Value>
class ComputedOnce {
 public:
  template <typename Compute>
  Value get(const std::string& key, const Compute& compute) {
    std::promise<Value> promise;
    std::shared_future<Value> value;
    bool is_mine = false;
    {
      const std::lock_guard lock(mutex_);
      const auto [known, is_new] = known_.try_emplace(key);
      is_mine = is_new;
      if (is_mine) known->second = promise.get_future().share();
      value = known->second;
    }
    if (is_mine) {
      try {
        promise.set_value(compute());
      } catch (...) {
        promise.set_exception(std::current_exception());
      }
    }
    return value.get();
  }
  std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return known_.size();
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_future<Value>> known_;
};

}  // namespace modcal
