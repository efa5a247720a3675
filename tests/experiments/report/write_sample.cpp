// write_sample DIR writes the sample report: for a look at it, and for the browser's test.
#include <cstdio>
#include <exception>

#include "experiments/report/report.hpp"
#include "tests/experiments/report/sample_report.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: write_sample DIR\n", stderr);
    return 2;
  }
  try {
    const auto written = modcal::report::write_report(modcal::report::sample_report(), argv[1]);
    std::printf("%s\n%s\n", written.page.c_str(), written.warning.c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
