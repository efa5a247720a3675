// write_config_reports CONFIGS DIR runs every experiment file at a small size and writes their
// reports with the figures that gnuplot draws, and DIR/pages, a path a line: for the tests that
// look at them.
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "experiments/report/report.hpp"
#include "tests/experiments/kinds/small_config.hpp"

namespace modcal {
namespace {

// Returns how many were written with a warning.
int write_reports(const std::string& configs, const std::filesystem::path& folder) {
  if (std::filesystem::exists(folder / "pages")) std::filesystem::remove_all(folder);
  if (!std::filesystem::create_directories(folder)) {
    throw std::runtime_error(folder.string() + " is there and not of this program");
  }
  std::ofstream pages(folder / "pages");
  int warned = 0;
  for (const std::string& file : config_files(configs)) {
    const LoadedExperiment small = load_small(file, load_experiment(file));
    SharedWork work;
    StudyResult result = small.experiment->run(
        {.work = work, .folder = small.document.folder(), .command = "modcal run " + file});
    report::Report report{.title = small.title, .description = small.description};
    report.status_text = result.answer;
    result.move_to(report, "Results", "Details");
    std::filesystem::path name = std::filesystem::relative(file, configs).replace_extension();
    const auto written = write_report(report, folder / name, {.vector_figures = true});
    if (!(pages << written.page.string() << std::endl))
      throw std::runtime_error("no list of pages");
    if (written.warning.empty()) continue;
    ++warned;
    std::fprintf(stderr, "%s: %s\n", file.c_str(), written.warning.c_str());
  }
  return warned;
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: write_config_reports CONFIGS DIR\n", stderr);
    return 2;
  }
  try {
    return modcal::write_reports(argv[1], argv[2]) == 0 ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
