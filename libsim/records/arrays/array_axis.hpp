// What tells how the values of an array lie in time or over frequency.
#pragma once

#include "libsim/records/arrays/array_notes.hpp"

namespace modcal {

/// The axes of the arrays of one file; instants that contradict each other are read once.
class ArrayAxes {
 public:
  ArrayAxes(Content content, bool headers_only)
      : content_(std::move(content)), headers_only_(headers_only) {}

  /// Rate, instants and beginning. A number tells the rate unless instants stand nearer; whatever
  /// else tells it must agree.
  void set(const NamedArray& array, StoredChannel& channel);

 private:
  void set_times(const NamedArray& time, StoredChannel& channel) const;
  void set_start(const NamedArray& array, std::size_t least_scope, StoredChannel& channel) const;
  void set_stated(const NamedArray& array, const NamedArray& told, StoredChannel& channel) const;
  const std::string& contradiction(const NamedArray& time, const NamedArray& array);

  Content content_;
  bool headers_only_;
  std::map<std::size_t, std::string> contradictions_;  // by place
};

/// The vector of lines of an array, or the number that they are multiples of; null: nothing tells
/// them.
const NamedArray* lines_of(const Content& content, const NamedArray& array);

}  // namespace modcal
