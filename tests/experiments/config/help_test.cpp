#include "experiments/config/help.hpp"

#include <gtest/gtest.h>

#include "tests/experiments/config/example_options.hpp"
#include "tests/experiments/config/json_schema.hpp"

namespace modcal::help_test {
namespace {

using nlohmann::json;
using testing::ExampleOptions;
using testing::JsonSchema;

JsonSchema example_schema() {
  ExampleOptions options;
  return JsonSchema(
      json::parse(options_schema([&](OptionVisitor& visitor) { options.visit(visitor); }).dump()));
}

json right() {
  return {{"string", {{"length", "0.33 m"}, {"linear_density", 3.1e-3}, {"fundamental", 196}}},
          {"windows", {"0.7 s", 0.78}}};
}

TEST(OptionsSchema, AcceptsRightOptions) {
  const JsonSchema schema = example_schema();
  EXPECT_TRUE(schema.accepts(right()));
  json full = right();
  full["string"]["damping"] = "constant";
  full["string"]["modes"] = "auto";
  full["stop"] = "end";
  full["seeds"] = {1, 2};
  full["content"] = "spectra";
  full["band"] = {{"low", 1}};
  full["bands"] = {{{"low", 1}}, {{"low", "2 Hz"}, {"high", 3}}};
  EXPECT_TRUE(schema.accepts(full));
  full["string"]["damping"] = {{"type", "polynomial"}, {"coefficients", {1e-3, "2 %"}}};
  EXPECT_TRUE(schema.accepts(full));
}

TEST(OptionsSchema, RejectsWrongOptions) {
  const JsonSchema schema = example_schema();
  const std::vector<std::pair<std::string, json>> wrong = {
      {"/decya", 5},
      {"/decay", "long"},
      {"/decay", true},
      {"/stop", "never"},
      {"/share", 1.5},
      {"/seeds", {1.5}},
      {"/remove_mean", "yes"},
      {"/content", "spectrum"},
      {"/band", {{"high", 1}}},
      {"/bands", {{{"low", 1}, {"middle", 2}}}},
      {"/string/modes", 0},
      {"/string/modes", "all"},
      {"/string/length", 0},
      {"/string/length", -0.33},
      {"/string/damping", "constnt"},
      {"/string/damping", {{"ratio", 1e-3}}},
      {"/string/damping", {{"type", "constant"}, {"coefficients", {1}}}},
      {"/string/damping", {{"type", "constant"}, {"ratio", 1.0}}},
  };
  for (const auto& [path, value] : wrong) {
    json document = right();
    document[json::json_pointer(path)] = value;
    EXPECT_FALSE(schema.accepts(document)) << path << " " << value;
  }
  json missing = right();
  missing["string"].erase("length");
  EXPECT_FALSE(schema.accepts(missing));
  EXPECT_FALSE(schema.accepts({{"windows", {1}}}));
}

}  // namespace
}  // namespace modcal::help_test
