// The tests of one source file of a program that holds those of many: PROGRAM [FILE] [flags of
// GoogleTest].
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <string_view>

#include "tests/leaks_of_libraries.hpp"

namespace {

// GoogleTest's filter for the tests of the file; empty where there are none.
std::string tests_of(std::string_view file) {
  std::string names;
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  for (int s = 0; s < all.total_test_suite_count(); ++s) {
    const testing::TestSuite& suite = *all.GetTestSuite(s);
    for (int t = 0; t < suite.total_test_count(); ++t) {
      const testing::TestInfo& test = *suite.GetTestInfo(t);
      if (!std::string_view(test.file()).ends_with(file)) continue;
      names += fmt::format("{}{}.{}", names.empty() ? "" : ":", suite.name(), test.name());
    }
  }
  return names;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  if (argc > 1) {
    const std::string names = tests_of(argv[1]);
    if (names.empty()) {
      fmt::print(stderr, "{}: no test of this program is written there\n", argv[1]);
      return 2;
    }
    // A filter that is stated leaves tests out: "-Suite.Name".
    const std::string left_out = GTEST_FLAG_GET(filter);
    GTEST_FLAG_SET(filter, left_out.starts_with('-') ? names + left_out : names);
  }
  return RUN_ALL_TESTS();
}
