#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "experiments/report/encoding.hpp"
#include "experiments/report/html_page.hpp"
#include "tests/experiments/report/sample_report.hpp"

namespace modcal::report::chart_data_test {
namespace {

std::string base64_of(std::string_view text) {
  return base64({reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

TEST(Base64, PrintsTheVectorsOfTheStandard) {  // RFC 4648, section 10
  EXPECT_EQ(base64_of(""), "");
  EXPECT_EQ(base64_of("f"), "Zg==");
  EXPECT_EQ(base64_of("fo"), "Zm8=");
  EXPECT_EQ(base64_of("foo"), "Zm9v");
  EXPECT_EQ(base64_of("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64_of("\xff\xfe\xfd"), "//79");
}

std::vector<unsigned char> decoded(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> bytes;
  unsigned group = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    group = group << 6 | static_cast<unsigned>(digits.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<unsigned char>(group >> bits & 255u));
  }
  return bytes;
}

// The values as the page's script reads them.
std::vector<double> values_of(const nlohmann::json& array) {
  const auto bytes = decoded(array["d"].get<std::string>());
  const bool wide = array["t"] == "f8";
  const std::size_t width = wide ? 8 : 4;
  std::vector<double> values(bytes.size() / width);
  for (std::size_t i = 0; i < values.size(); ++i) {
    float narrow = 0.0F;
    if (wide) std::memcpy(&values[i], &bytes[8 * i], 8);
    if (!wide) std::memcpy(&narrow, &bytes[4 * i], 4);
    if (!wide) values[i] = array["o"].get<double>() + static_cast<double>(narrow);
  }
  return values;
}

nlohmann::json data_of(const Figure& figure) {
  const std::array drawn = {draw_figure(figure, 1000)};
  return nlohmann::json::parse(chart_data_json(drawn));
}

TEST(ChartData, ReturnsTheSamplesToSevenDigits) {
  const Figure figure = waveform_figure();
  const auto data = data_of(figure);
  const auto& series = data["figures"][0]["panels"][4]["series"][0];
  const auto x = values_of(data["arrays"][series["x"].get<std::size_t>()]);
  const auto y = values_of(data["arrays"][series["y"].get<std::size_t>()]);
  const Series& truth = figure.panels[4].series[0];
  ASSERT_EQ(x.size(), truth.x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    // float32 about the first abscissa: half a unit in the last place of the span of 0.02 s.
    EXPECT_NEAR(x[i], truth.x[i], 0.02 * 6e-8);
    EXPECT_NEAR(y[i], truth.y[i], std::abs(truth.y[i]) * 6e-8);
  }
}

TEST(ChartData, WritesEqualArraysOnce) {
  const auto data = data_of(waveform_figure());
  // One x; y, v and f_c: computed (equal on both sides) and identified from R1 and from R2.
  EXPECT_EQ(data["arrays"].size(), 1u + 3u * 3u);
}

TEST(ChartData, ShortArraysAndHugeValuesKeepAllDigits) {
  Series series{.label = "a", .x = {1.0 / 3.0}, .y = {1e300}};
  for (int i = 1; i < 1000; ++i) {
    series.x.push_back(i);
    series.y.push_back(1e300 / i);
  }
  const Figure figure{.id = "f",
                      .title = "",
                      .caption = "",
                      .panels = {{.title = "",
                                  .x = {.label = "x", .unit = "s"},
                                  .y = {.label = "y", .unit = "m"},
                                  .series = {series}}},
                      .command = ""};
  const auto data = data_of(figure);
  const auto& written = data["figures"][0]["panels"][0]["series"][0];
  EXPECT_EQ(values_of(data["arrays"][written["y"].get<std::size_t>()]), series.y);
  const auto curves = data_of(curve_figure());
  EXPECT_EQ(curves["arrays"][0]["t"], "f8");
}

TEST(ChartData, CurvesThatTurnBackAreSortedAndKeepTheirPath) {
  const Figure figure = long_figure();
  const auto data = data_of(figure);
  const auto& written = data["figures"][0]["panels"][1]["series"][0];
  const auto array = [&](const char* key) {
    return values_of(data["arrays"][written[key].get<std::size_t>()]);
  };
  const auto x = array("x");
  const auto path = array("path");
  EXPECT_TRUE(std::is_sorted(x.begin(), x.end()));
  const Series& loop = figure.panels[1].series[0];
  ASSERT_EQ(path.size(), loop.x.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    // float32 about the lowest abscissa: half a unit in the last place of the span of 2.
    EXPECT_NEAR(x[static_cast<std::size_t>(path[i])], loop.x[i], 2 * 6e-8);
  }
  EXPECT_FALSE(data["figures"][0]["panels"][0]["series"][0].contains("path"));
}

TEST(ChartData, CannotEndTheScriptElementOrCarryBrokenText) {
  Figure figure = objective_figure();
  figure.panels[0].series[0].label = "</script><script>alert(1)</script><!--";
  figure.panels[0].x.label = "broken \xff text";
  const std::array drawn = {draw_figure(figure, 100)};
  const std::string text = chart_data_json(drawn);
  EXPECT_EQ(text.find('<'), std::string::npos);
  const auto data = nlohmann::json::parse(text);
  EXPECT_EQ(data["figures"][0]["panels"][0]["series"][0]["label"],
            figure.panels[0].series[0].label);
}

}  // namespace
}  // namespace modcal::report::chart_data_test
