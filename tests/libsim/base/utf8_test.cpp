#include "libsim/base/utf8.hpp"

#include <gtest/gtest.h>

namespace modcal::utf8_test {
namespace {

TEST(Utf8, TakesWhatRfc3629TakesAndNothingElse) {
  for (const char* good : {"a", "µ", "€", "\xF0\x9F\x8E\xBB", "\xED\x9F\xBF", "\xF4\x8F\xBF\xBF"}) {
    EXPECT_EQ(utf8_size(good), std::string_view(good).size()) << good;
  }
  // Latin-1, cut off, too long, a half of a pair, beyond the last character.
  for (const char* bad : {"\xE9", "\xE2\x82", "\xC0\xAF", "\xE0\x80\xAF", "\xF0\x80\x80\xAF",
                          "\xED\xA0\x80", "\xF4\x90\x80\x80", "\x80"}) {
    EXPECT_EQ(utf8_size(bad), 0u);
  }
  EXPECT_EQ(first_not_utf8("Gr\xC3\xB6\xDF"), 4u);
  EXPECT_EQ(first_not_utf8("Größe"), std::string_view::npos);
  EXPECT_EQ(count_characters("Größe"), 5u);
}

TEST(Utf8, ReadsWhatIsNotUtf8AsLatin1) {
  EXPECT_EQ(utf8_or_latin1("Kraft [\xB5N]"), "Kraft [µN]");
  EXPECT_EQ(utf8_or_latin1("Gr\xF6\xDF"
                           "e"),
            "Größe");
  EXPECT_EQ(utf8_or_latin1("Größe"), "Größe");
}

TEST(Utf8, WritesOutWhatATerminalObeys) {
  EXPECT_EQ(printable("a\tb\n"), "a\tb\n");
  EXPECT_EQ(printable("Größe €"), "Größe €");
  EXPECT_EQ(printable("\033[2Jgone\r"), "\\x1b[2Jgone\\x0d");
  EXPECT_EQ(printable("\xC2\x9B"
                      "31m"),
            "\\xc2\\x9b31m");  // an escape code in two bytes
  EXPECT_EQ(printable("caf\xE9\x7F"), "caf\\xe9\\x7f");
}

}  // namespace
}  // namespace modcal::utf8_test
