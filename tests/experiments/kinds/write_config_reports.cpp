// write_config_reports CONFIGS DIR [FIGURES] runs every experiment file at a small size and writes
// their reports: for the browser's test. With a third argument, whatever it is, gnuplot draws their
// figures, too.
#include <cstdio>

#include "experiments/report/report.hpp"
#include "tests/experiments/kinds/small_config.hpp"

namespace modcal {
namespace {

void write_reports(const std::string& configs, const std::filesystem::path& folder,
                   bool vector_figures) {
  for (const std::string& file : config_files(configs)) {
    const LoadedExperiment small = load_small(file, load_experiment(file));
    SharedWork work;
    StudyResult result = small.experiment->run(
        {.work = work, .folder = small.document.folder(), .command = "modcal run " + file});
    report::Report report{.title = small.title, .description = small.description};
    report.status_text = result.answer;
    result.move_to(report, "Results", "Details");
    std::filesystem::path name = std::filesystem::relative(file, configs).replace_extension();
    const auto written = write_report(report, folder / name, {.vector_figures = vector_figures});
    std::printf("%s\n", written.page.c_str());
    if (!written.warning.empty()) std::fprintf(stderr, "%s\n", written.warning.c_str());
  }
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::fputs("usage: write_config_reports CONFIGS DIR [FIGURES]\n", stderr);
    return 2;
  }
  try {
    modcal::write_reports(argv[1], argv[2], argc == 4);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
