// Experiments that run in memory, and every command of the program as one call.
#include <pybind11/stl.h>
#include <tbb/global_control.h>

#include <nlohmann/json.hpp>

#include "experiments/cli/command.hpp"
#include "experiments/cli/runner.hpp"
#include "experiments/kinds/structure/structure_files.hpp"
#include "experiments/loader.hpp"
#include "experiments/runs/task_experiment.hpp"
#include "libsim/records/record_file.hpp"
#include "python/core/arrays.hpp"
#include "python/core/errors.hpp"
#include "python/core/models.hpp"
#include "python/core/module.hpp"
#include "python/core/results.hpp"
#include "python/core/searches.hpp"
#include "python/core/watched.hpp"

namespace modcal::python {
namespace {

/// An experiment without mistakes.
struct Opened {
  LoadedExperiment loaded;
  std::filesystem::path folder() const {
    const auto folder = loaded.document.folder();
    return folder.empty() ? "." : folder;
  }
};

Opened open(const std::string& source, bool is_text, const std::vector<std::string>& assignments,
            bool with_records) {
  YamlDocument document = is_text ? parse_yaml(source, "<text>") : read_yaml_file(source);
  for (std::size_t i = 0; i < assignments.size(); ++i) {
    apply_assignment(document, assignments[i], i + 1);
  }
  Opened opened{load_experiment(std::move(document))};
  if (with_records) check_records(opened.loaded);
  if (opened.loaded.has_errors()) {
    throw Refusal(complaints_of(opened.loaded.document, opened.loaded.mistakes));
  }
  return opened;
}

std::vector<std::string> warnings_of(const Opened& opened) {
  std::vector<std::string> texts;
  for (const Complaint& complaint : complaints_of(opened.loaded.document, opened.loaded.mistakes)) {
    texts.push_back(message_of(complaint));
  }
  return texts;
}

// Calls work(context) beside Python.
template <typename Work>
auto with_context(const Opened& opened, const py::object& progress, int threads, const Work& work) {
  return watched(progress, [&](const Watch& watch) {
    std::optional<tbb::global_control> limit;
    if (threads > 0) {
      limit.emplace(tbb::global_control::max_allowed_parallelism,
                    static_cast<std::size_t>(threads));
    }
    const StopToken stop(watch.stop);
    SharedWork shared(stop);
    auto result = work(StudyContext{.work = shared,
                                    .folder = opened.folder(),
                                    .command = "modcal.run",
                                    .progress = watch.progress,
                                    .stop = stop});
    stop.throw_if_requested();
    return result;
  });
}

std::shared_ptr<Outcome> run(const Opened& opened, const py::object& progress, int threads) {
  const Stopwatch clock;
  StudyResult result = with_context(opened, progress, threads, [&](const StudyContext& context) {
    return opened.loaded.experiment->run(context);
  });
  return std::make_shared<Outcome>(Outcome{std::move(result), clock.seconds()});
}

Search search(const Opened& opened, const py::object& progress) {
  auto task = with_context(opened, progress, 0, [&](const StudyContext& context) {
    return opened.loaded.experiment->search_task(context);
  });
  MODCAL_REQUIRE(task != nullptr,
                 "kind {} searches nothing: a problem is the search of kind: calibrate",
                 opened.loaded.kind);
  return Search(std::move(task));
}

// Exit code and JSON answer of a command line.
std::pair<int, std::string> ask(const std::vector<std::string>& words, const py::object& progress) {
  return watched(progress, [&](const Watch& watch) {
    std::vector<const char*> line{"modcal"};
    for (const std::string& word : words) line.push_back(word.c_str());
    Caller caller(watch.stop, watch.progress);
    const ExitCode code = answer_words(static_cast<int>(line.size()), line.data(), [] {});
    return std::pair(static_cast<int>(code), std::move(caller.said));
  });
}

// Of the finished tasks of a folder: a JSON object for each, its axes and what it left.
std::string finished_tasks(const std::string& folder) {
  const StoredRun run(folder);
  auto rows = nlohmann::ordered_json::array();
  for (std::size_t task = 0; task < run.tasks(); ++task) {
    const auto finished = run.outcomes()[task];
    if (!finished) continue;
    nlohmann::ordered_json row = {{"task", task}, {"seconds", finished->seconds}};
    const std::vector<std::string> values = run.list().axis_values(task);
    for (std::size_t i = 0; i < values.size(); ++i) row[run.list().axes()[i]] = values[i];
    row["outcome"] = nlohmann::ordered_json::parse(finished->outcome);
    rows.push_back(std::move(row));
  }
  return rows.dump();
}

std::unique_ptr<GivenRecording> give(
    const std::string& name, double sample_rate,
    const std::vector<std::tuple<std::string, std::string, Numbers>>& channels) {
  Recording recording;
  recording.format = "array";
  recording.sample_rate = sample_rate;
  recording.rate_source = "as stated by the user";
  for (const auto& [channel, kind, samples] : channels) {
    const auto held = span_of(samples);
    recording.channels.push_back({channel,
                                  std::string(unit_of(kind_of_sensor(channel, kind))),
                                  1.0,
                                  {held.begin(), held.end()}});
  }
  return std::make_unique<GivenRecording>(name, std::move(recording));
}

}  // namespace

void add_experiments(py::module_& module) {
  answer_style() = {.json = true, .quiet = true};
  py::class_<Opened>(module, "Experiment")
      .def_property_readonly("kind", [](const Opened& self) { return self.loaded.kind; })
      .def_property_readonly("title", [](const Opened& self) { return self.loaded.title; })
      .def_property_readonly("warnings", &warnings_of)
      .def("resolved", [](const Opened& self) { return self.loaded.resolved(); })
      .def("run", &run, py::arg("progress"), py::arg("threads"))
      .def("search", &search, py::arg("progress"));
  py::class_<GivenRecording>(module, "GivenRecording")
      .def(py::init(&give), py::arg("name"), py::arg("sample_rate"), py::arg("channels"));
  module.def("open", &open, py::arg("source"), py::arg("is_text"), py::arg("assignments"),
             py::arg("with_records"));
  module.def("finished_tasks", &finished_tasks, py::arg("folder"));
  module.def("ask", &ask, py::arg("words"), py::arg("progress"));
}

}  // namespace modcal::python
