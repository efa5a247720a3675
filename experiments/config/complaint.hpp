// What is wrong with what was asked, as one value: the printed message and what --json answers are
// both made of it.
#pragma once

#include <string>
#include <string_view>

#include "libsim/base/error.hpp"

namespace modcal {

/// A file, where it is known with line and column (from 1), or an option of the command line.
/// Empty: nowhere in particular.
struct InputPlace {
  std::string file = {};
  std::size_t line = 0;
  std::size_t column = 0;
  std::string option = {};  ///< "--set 1", "--length"

  bool empty() const { return file.empty() && option.empty(); }
};

/// "--length", "record.csv:4" or "record.csv".
InputPlace place_named(std::string_view name);

struct Complaint {
  enum class Grade { kError, kWarning, kInternalError };
  Grade grade = Grade::kError;
  InputPlace place = {};
  std::string text = {};    ///< reason and remedy
  std::string source = {};  ///< lines to be shown below: what stands there, and a caret
};

/// With the place, which the text begins with, as a value.
Complaint complaint_of(const InvalidInput& error);

/// "a.yaml:3:7: text", without the grade.
std::string message_of(const Complaint& complaint);
/// "a.yaml:3:7: error: text" or, where no column is known, "error: record.csv:4: text"; with the
/// lines below.
std::string printed(const Complaint& complaint);

}  // namespace modcal
