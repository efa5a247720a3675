// The stored outcome of a task: the first byte says of which kind of list.
#include <array>
#include <sstream>

#include "experiments/loader.hpp"
#include "experiments/runs/task_experiment.hpp"
#include "tests/folder_test.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace modcal::fuzz {
namespace {

// An experiment of tests/experiments/cli/wrong/bases.txt.
std::string base_of(const std::string& name) {
  std::istringstream lines(content_of(MODCAL_BASES));
  std::string text, group;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('|')) {
      group = line;
    } else if (group == name) {
      text += line.substr(std::min<std::size_t>(2, line.size())) + "\n";
    }
  }
  return text;
}

const TaskExperiment& list_of(std::size_t number) {
  static const auto kLists = [] {
    std::vector<LoadedExperiment> lists;
    for (const auto& [name, axes] :
         {std::pair("simulate", "sweep: {product: {seed: [1, 2]}}\n"),
          std::pair("invert", "sweep: {product: {seed: [1, 2]}}\n"),
          std::pair("calibrate", "sweep: {product: {seed: [1, 2]}}\n"),
          std::pair("pluck", "sweep: {product: {seed: [1, 2]}}\n"), std::pair("sweep", ""),
          std::pair("benchmark", ""), std::pair("limit", ""), std::pair("schelleng", "")}) {
      lists.push_back(load_experiment(parse_yaml(base_of(name) + axes, name)));
      const LoadedExperiment& loaded = lists.back();
      if (loaded.has_errors()) std::puts(format_mistakes(loaded.document, loaded.mistakes).c_str());
      require(!loaded.has_errors(), "a base is wrong");
    }
    return lists;
  }();
  return dynamic_cast<const TaskExperiment&>(*kLists[number % kLists.size()].experiment);
}

}  // namespace
}  // namespace modcal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace modcal;
  if (size == 0) return 0;
  const TaskExperiment& list = fuzz::list_of(data[0]);
  const std::string outcome(fuzz::text_of(data + 1, size - 1));
  fuzz::accepted([&] { list.failure_in(outcome); });
  fuzz::accepted([&] { list.loss_in(outcome); });
  fuzz::accepted([&] { list.number_in(outcome, "a"); });
  SharedWork work;
  const StudyContext context{.work = work, .folder = "/", .command = "modcal run"};
  TaskOutcomes outcomes(list.task_count());
  outcomes.put(0, FinishedTask{outcome, 1.0});
  fuzz::accepted([&] { list.sum_up(outcomes, context); });
  return 0;
}
