#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>

#include "experiments/report/drawing.hpp"
#include "experiments/report/encoding.hpp"
#include "libsim/base/files.hpp"

namespace modcal::report {
namespace {

namespace fs = std::filesystem;

struct Format {
  const char* extension;
  std::string_view ending;
};
constexpr std::array<Format, 2> kFormats = {{{".svg", "</svg>"}, {".pdf", "%%EOF"}}};

// The file ends as its format demands: gnuplot was not stopped while it drew.
bool is_complete(const fs::path& file, std::string_view ending) {
  constexpr std::streamoff kTail = 64;
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  if (!stream) return false;
  const std::streamoff size = stream.tellg();
  stream.seekg(std::max<std::streamoff>(0, size - kTail));
  const std::string tail{std::istreambuf_iterator<char>(stream), {}};
  return tail.find(ending) != std::string::npos;
}

// Files that gnuplot draws one figure to: new ones, which no link in the folder leads elsewhere.
class Drawn {
 public:
  Drawn(const fs::path& directory, const std::string& id) : id_(id) {
    for (const auto& [extension, ending] : kFormats) {
      parts_.push_back(std::make_unique<PartFile>(directory / (id + extension)));
    }
  }

  // Sets the names that the figure's script draws to.
  std::string names() const {
    std::string text;
    for (std::size_t i = 0; i < kFormats.size(); ++i) {
      text += fmt::format("output_{} = '{}'; ", std::string_view(kFormats[i].extension).substr(1),
                          parts_[i]->path().filename().string());
    }
    return text;
  }

  // Gives what was drawn to its end its name; returns what was not.
  std::vector<std::string> publish() {
    std::vector<std::string> missing;
    for (std::size_t i = 0; i < kFormats.size(); ++i) {
      if (is_complete(parts_[i]->path(), kFormats[i].ending)) {
        parts_[i]->put_in_place();
      } else {
        missing.push_back(id_ + kFormats[i].extension);
      }
    }
    return missing;
  }

 private:
  std::string id_;
  std::vector<std::unique_ptr<PartFile>> parts_;
};

// What the shell ends with where it cannot run a program.
constexpr int kNotExecutable = 126, kNotFound = 127;

}  // namespace

ProcessOutcome run_process(const std::vector<std::string>& arguments, const fs::path& directory) {
  const auto word = [](const std::string& text) { return quoted(text, '\'', "'\\''"); };
  std::string line = "cd " + word(directory.string()) + " && exec";
  for (const std::string& argument : arguments) line += ' ' + word(argument);
  ProcessOutcome outcome;
  std::FILE* const pipe = ::popen((line + " 2>&1 </dev/null").c_str(), "re");
  if (pipe == nullptr) return outcome;
  for (int letter = std::fgetc(pipe); letter != EOF; letter = std::fgetc(pipe)) {
    outcome.output += static_cast<char>(letter);
  }
  const int status = ::pclose(pipe);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.started = outcome.exit_code != kNotFound && outcome.exit_code != kNotExecutable;
  return outcome;
}

std::string draw_with_gnuplot(std::span<const DrawnFigure> figures, const fs::path& directory,
                              const std::string& program) {
  if (figures.empty()) return {};
  std::vector<std::string> arguments = {program};
  std::vector<Drawn> all;
  for (const DrawnFigure& figure : figures) {
    const std::string& id = figure.source->id;
    write_file_atomically(directory / (id + ".dat"), gnuplot_data(figure));
    write_file_atomically(directory / (id + ".gp"), gnuplot_script(figure));
    all.emplace_back(directory, id);
    arguments.insert(arguments.end(), {"-e", all.back().names(), id + ".gp"});
  }
  const ProcessOutcome outcome = run_process(arguments, directory);
  std::vector<std::string> missing;
  for (Drawn& drawn : all) {
    for (std::string& name : drawn.publish()) missing.push_back(std::move(name));
  }
  if (!outcome.started) {
    return fmt::format(
        "The program \"{}\" could not be started ({}): no SVG and PDF figures were drawn. Install "
        "the Debian package gnuplot-nox; the scripts and data are in {}.",
        program, outcome.output, directory.filename().string());
  }
  if (outcome.succeeded() && missing.empty()) return {};
  return fmt::format("{} ended with exit code {}; not drawn: {}. It said: {}", program,
                     outcome.exit_code, fmt::join(missing, ", "), outcome.output);
}

}  // namespace modcal::report
