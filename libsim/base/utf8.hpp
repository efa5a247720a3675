// Text that others wrote: which bytes are UTF-8 (RFC 3629), and how it can be shown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace modcal {

/// Bytes of the UTF-8 character that begins the text, which is not empty; 0 where none does, or a
/// NUL.
std::size_t utf8_size(std::string_view text);

/// Place of the first byte that is not UTF-8; npos where all are.
std::size_t first_not_utf8(std::string_view text);

/// Appends a character by its code point (< 0x110000).
void append_utf8(std::uint32_t letter, std::string& text);

/// Number of characters of UTF-8 text.
std::size_t count_characters(std::string_view text);

/// The text; read as Latin-1 (ISO 8859-1), as older programs write it, where it is not UTF-8.
std::string utf8_or_latin1(std::string_view text);

/// The text with what a terminal would obey, or could not show, written out: control characters but
/// line ends and tabs as \x1b, bytes that are not UTF-8 as \xe9.
std::string printable(std::string_view text);

}  // namespace modcal
