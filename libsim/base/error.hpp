// Errors a user can cause, apart from bugs (assert) and numerical outcomes (values in results).
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace modcal {

/// Wrong input: says what was given, why it cannot be used and what to do about it.
/// The edge (YAML reader, command line) adds file, line and column.
class InvalidInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  /// of a text that begins with "place: "
  InvalidInput(const std::string& text, std::string place)
      : std::runtime_error(text), place_(std::move(place)) {}

  /// "record.csv:4": the file and its line, the folder or the option; empty: none is known.
  const std::string& place() const { return place_; }

 private:
  std::string place_;
};

/// Work stopped because the user asked for it (Ctrl-C).
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

/// The arguments before the first ": " of a format that begins with "{}: " or "{}:{}: " are a
/// place.
[[noreturn]] void throw_formatted(fmt::string_view text, fmt::format_args args);

template <typename... Args>
[[noreturn]] void throw_invalid_input(fmt::format_string<Args...> text, Args&&... args) {
  throw_formatted(text, fmt::make_format_args(args...));
}

}  // namespace modcal

/// Throws InvalidInput with the formatted text unless the condition holds. A comparison with NaN is
/// false, so conditions are written as what must be true.
#define MODCAL_REQUIRE(condition, ...)            \
  do {                                            \
    if (!(condition)) {                           \
      ::modcal::throw_invalid_input(__VA_ARGS__); \
    }                                             \
  } while (false)
