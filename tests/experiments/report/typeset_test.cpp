#include "experiments/report/typeset.hpp"

#include <gtest/gtest.h>

namespace modcal::report::typeset_test {
namespace {

TEST(Typeset, WritesPowersOfTen) {
  EXPECT_EQ(typeset_powers("B = 2.988e-09."), "B = 2.988×10⁻⁹.");
  EXPECT_EQ(typeset_powers("1e-3 of 1.50e+12"), "10⁻³ of 1.50×10¹²");
  EXPECT_EQ(typeset_powers("-2e-5 (sd 5.8e-09)"), "−2×10⁻⁵ (sd 5.8×10⁻⁹)");
}

TEST(Typeset, LeavesNamesAlone) {
  for (const char* text : {"file_1e-3.csv", "sweep3e-2x", "e-3", "v1.2e-rc", "see-1"}) {
    EXPECT_EQ(typeset_powers(text), text);
  }
  for (const char* text : {"time_s", "out/f_1", "noise_rms_1", "joint_likelihood", "a_long_name"}) {
    EXPECT_EQ(typeset_html(text), text);
  }
}

TEST(Typeset, WritesSubscripts) {
  EXPECT_EQ(typeset_html("f_n over n f_0 √(1 + B n²)"),
            "f<sub>n</sub> over n f<sub>0</sub> √(1 + B n²)");
  EXPECT_EQ(typeset_html("|φ_n(x_c)|, f_12"), "|φ<sub>n</sub>(x<sub>c</sub>)|, f<sub>12</sub>");
  EXPECT_EQ(typeset_html("f0 from R1 and R2/H2"),
            "f<sub>0</sub> from R<sub>1</sub> and R<sub>2</sub>/H2");
}

TEST(Typeset, KnowsTheWordsOfTheProgram) {
  EXPECT_EQ(typeset_html("reduced chi2 1.01, zeta_12: 1 +- 0.3"),
            "reduced χ² 1.01, ζ<sub>12</sub>: 1 ± 0.3");
}

TEST(Typeset, EscapesWhatHtmlWouldTake) {
  EXPECT_EQ(typeset_html("<b>x_c & \"1e-2\""), "&lt;b&gt;x<sub>c</sub> &amp; &quot;10⁻²&quot;");
}

}  // namespace
}  // namespace modcal::report::typeset_test
