// Lines of universal files: fields in columns of characters.
#pragma once

#include <string>
#include <string_view>

namespace modcal {

/// Whether the line begins or ends a dataset: -1.
bool is_delimiter(std::string_view line);

/// A field of text; "NONE" is empty.
std::string known_field(std::string_view text);

/// A line in columns of characters, whatever bytes they have. Throws InvalidInput that begins with
/// `where`.
class Columns {
 public:
  Columns(std::string_view line, std::string where);

  std::string_view text(std::size_t first, std::size_t count) const;
  /// 0 where the field is empty.
  long long whole(std::size_t first, std::size_t count) const;
  /// The same within seven digits.
  int small(std::size_t first, std::size_t count) const;
  /// 0 where the field is empty; D is an exponent, too.
  double number(std::size_t first, std::size_t count) const;
  /// The same where a number must stand.
  double stated_number(std::size_t first, std::size_t count) const;

 private:
  std::size_t byte(std::size_t column) const;
  std::string text_, where_;
};

}  // namespace modcal
