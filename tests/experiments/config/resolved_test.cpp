#include <gtest/gtest.h>

#include <cmath>

#include "experiments/config/help.hpp"
#include "experiments/config/reader.hpp"
#include "libsim/model/damping.hpp"
#include "tests/experiments/config/example_options.hpp"

namespace modcal::resolved_test {
namespace {

using testing::Band;
using testing::ExampleOptions;

std::string resolved(ExampleOptions options) {
  ResolvedWriter writer;
  options.visit(writer);
  return writer.yaml();
}

ExampleOptions read_back(const std::string& yaml) {
  const YamlDocument document = parse_yaml(yaml, "resolved.yaml");
  std::vector<Mistake> mistakes = document.mistakes;
  ExampleOptions options;
  options.stop = 0.0;
  read_options(
      document.root, [&](OptionVisitor& visitor) { options.visit(visitor); }, mistakes);
  EXPECT_EQ(format_mistakes(document, mistakes), "") << yaml;
  return options;
}

ExampleOptions awkward() {
  ExampleOptions options;
  options.string.length = 1.0 / 3.0;
  options.string.linear_density = 5e-324;
  options.string.fundamental = 1.7976931348623157e308;
  options.string.inharmonicity = 1.4e-4;
  options.string.modes = 0;
  options.string.damping = Choice<DampingLaw>::of<PolynomialDamping>(
      "polynomial", {.coefficients = {-0.0, 1e-3, 0.1 + 0.2}});
  options.windows = {0.1, 1e22, 123456789.123456789};
  options.seeds = {9223372036854775807, -1};
  options.bands = {Band{.low = 1e-7, .high = 3.0}, Band{.low = 2.0, .high = 4.0}};
  options.has_band = true;
  return options;
}

TEST(ResolvedWriter, ReadsBackAsTheSameBits) {
  ExampleOptions options = awkward();
  const std::string yaml = resolved(options);
  const ExampleOptions again = read_back(yaml);
  EXPECT_EQ(again.string.length, options.string.length);
  EXPECT_EQ(again.string.linear_density, options.string.linear_density);
  EXPECT_EQ(again.string.fundamental, options.string.fundamental);
  EXPECT_EQ(again.share, options.share);
  EXPECT_NE(yaml.find("modes: auto"), std::string::npos);
  EXPECT_TRUE(again.string.modes_of_record());
  EXPECT_TRUE(std::isnan(again.stop));
  EXPECT_EQ(again.windows, options.windows);
  EXPECT_EQ(again.seeds, options.seeds);
  EXPECT_EQ(again.note, options.note);
  EXPECT_EQ(again.quantities, options.quantities);
  EXPECT_TRUE(again.has_band);
  ASSERT_EQ(again.bands.size(), 2u);
  EXPECT_EQ(again.bands[0].low, 1e-7);
  EXPECT_EQ(again.string.damping.selected(), "polynomial");
  EXPECT_EQ(again.optional_damping.selected(), "");
  // Texts show every digit, so equal texts mean equal bits (of -0.0, too).
  EXPECT_EQ(resolved(again), yaml);
}

TEST(ResolvedWriter, WritesTextsThatReadBackAsTheSame) {
  for (const std::string text :
       {"",   "null", "~",   "true", "1 2", "- a",       "a: b",    "a #b",
        " a", "a ",   "'",   "\"",   "\\",  "\t",        "\x01",    "&a",
        "*a", "[",    "{a}", "%x",   "@",   "two words", "a/b.csv", "\xE2\x80\xA8"}) {
    ExampleOptions options = awkward();
    options.note = text;
    options.quantities = {text, "x"};
    const ExampleOptions again = read_back(resolved(options));
    EXPECT_EQ(again.note, text);
    EXPECT_EQ(again.quantities, options.quantities);
  }
}

TEST(ResolvedWriter, AsksForValuesAloneThatAreMissing) {
  EXPECT_EQ(resolved(awkward()).find("fill in"), std::string::npos);
  ExampleOptions options = awkward();
  options.string.length = std::numeric_limits<double>::quiet_NaN();
  const std::string yaml = resolved(options);
  const std::size_t asked = yaml.find("[m]: fill in");
  ASSERT_NE(asked, std::string::npos);
  EXPECT_EQ(yaml.find("fill in", asked + 8), std::string::npos);
}

}  // namespace
}  // namespace modcal::resolved_test
