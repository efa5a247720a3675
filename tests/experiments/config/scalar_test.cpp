#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <thread>
#include <vector>

#include "experiments/config/reader.hpp"
#include "libsim/base/units.hpp"

namespace modcal::scalar_test {
namespace {

struct Reading {
  std::string_view text;
  std::string_view unit;
  double expected;
};

TEST(ParseNumber, GivesTheBitsOfTheSameNumberWrittenInSiUnits) {
  for (const auto& [text, unit, expected] : std::vector<Reading>{{"0.33", "m", 0.33},
                                                                 {"30 mm", "m", 0.03},
                                                                 {"30mm", "m", 0.03},
                                                                 {"51.2 kHz", "Hz", 51200.0},
                                                                 {"1 us", "s", 1e-6},
                                                                 {"1 \xC2\xB5s", "s", 1e-6},
                                                                 {"3.1 g/m", "kg/m", 3.1e-3},
                                                                 {"3.1e-3 kg/m", "kg/m", 3.1e-3},
                                                                 {"5 s/m", "s/m", 5.0},
                                                                 {"5 ms/mm", "s/m", 5.0},
                                                                 {"1e5 N/m", "N/m", 1e5},
                                                                 {"1E+5 N/m", "N/m", 1e5},
                                                                 {"2 %", "1", 0.02},
                                                                 {"7%", "1", 0.07},
                                                                 {"+1.5 mm", "m", 1.5e-3},
                                                                 {"-0.3 mm", "m", -0.3e-3},
                                                                 {".5", "1", 0.5},
                                                                 {"5.", "1", 5.0},
                                                                 {"1e-310", "1", 1e-310},
                                                                 {"3 m s-1", "m/s", 3.0},
                                                                 {"4 1/s", "1/s", 4.0},
                                                                 {"0.1 ms", "s", 1e-4},
                                                                 {"1e3 mm", "m", 1.0}}) {
    const ScalarNumber number = parse_number(text, unit);
    EXPECT_EQ(number.error, "") << text;
    EXPECT_EQ(number.value, expected) << text;
  }
}

TEST(ParseNumber, ConvertsUnitsThatAreNoPowersOfTen) {
  // One rounding of the factor and one of the product.
  EXPECT_NEAR(parse_number("2 min", "s").value, 120.0, 120.0 * 4.5e-16);
  EXPECT_NEAR(parse_number("13 inch", "m").value, 0.3302, 0.3302 * 4.5e-16);
}

struct Refusal {
  std::string_view text;
  std::string_view unit;
  std::string_view error;
};

TEST(ParseNumber, SaysWhyATextIsNoNumber) {
  for (const auto& [text, unit, error] : std::vector<Refusal>{
           {"long", "m", "\"long\" is not a number: a number in m, such as 30 mm, is needed"},
           {"", "1", "there is no value: a number is needed"},
           {"nan", "1", "\"nan\" is not a number: a number is needed"},
           {"inf", "1", "\"inf\" is not a number: a number is needed"},
           {".nan", "1", "\".nan\" is not finite: a number is needed"},
           {"-.inf", "1", "\"-.inf\" is not a number: a number is needed"},
           {"+-1", "1", "\"+-1\" is not a number: a number is needed"},
           {"1e999", "1", "\"1e999\" is beyond the range of numbers"},
           {"1e308 km", "m", "\"1e308 km\" is beyond the range of numbers"},
           {"010", "1", "\"010\" looks octal: write it without the leading 0"},
           {"00.5", "1", "\"00.5\" looks octal: write it without the leading 0"},
           {"-010", "1", "\"-010\" looks octal: write it without the leading 0"},
           {"0,33", "m", "\"0,33\": write a decimal point, not a comma"},
           {"0x1F", "1", "\"0x1F\": x1F is not a unit; a number is needed"},
           {"1_000", "1", "\"1_000\": _000 is not a unit; a number is needed"},
           {"30 mmm", "m",
            "\"30 mmm\": mmm is not a unit, did you mean \"mm\"?; a number in m, such as 30 mm, is "
            "needed"},
           {"51.2 khz", "Hz",
            "\"51.2 khz\": khz is not a unit, did you mean \"kHz\"?; a number in Hz, such as 51.2 "
            "kHz, is needed"},
           {"30 kg", "m",
            "\"30 kg\" has the unit kg, which cannot be converted to m: a number in m, such as 30 "
            "mm, is needed"},
           {"5 m", "1",
            "\"5 m\" has the unit m, which cannot be converted to a pure number: a number is "
            "needed"}}) {
    EXPECT_EQ(parse_number(text, unit).error, error);
  }
}

TEST(ParseNumber, RefusesWhatTheUnitLibraryAloneWouldConvertOrRead) {
  // Reciprocals, angles, factors, powers and time stamps.
  for (const auto& [text, unit] :
       std::vector<std::pair<std::string_view, std::string_view>>{{"5 ms", "Hz"},
                                                                  {"1231 rad/s", "Hz"},
                                                                  {"60 rpm", "Hz"},
                                                                  {"3 rad", "1"},
                                                                  {"0.33 20 m", "m"},
                                                                  {"0.33 m 0.5", "m"},
                                                                  {"0.33 (2 m)", "m"},
                                                                  {"3 s since 2000-01-01", "s"}}) {
    EXPECT_NE(parse_number(text, unit).error, "") << text;
  }
}

TEST(UnitScale, CanBeAskedByManyThreads) {
  std::vector<std::thread> threads;
  std::vector<int> right(8, 0);
  for (int& count : right) {
    threads.emplace_back([&count] {
      for (int i = 0; i < 200; ++i) count += parse_number("30 mm", "m").value == 0.03 ? 1 : 0;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(right, ::testing::Each(200));
}

}  // namespace
}  // namespace modcal::scalar_test
