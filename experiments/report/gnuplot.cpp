#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <system_error>

#include "experiments/report/drawing.hpp"
#include "experiments/report/encoding.hpp"

namespace modcal::report {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSuffix = ".part";

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

// Gives the drawn file its name; false where there is none.
bool publish(const fs::path& file, std::string_view ending) {
  const fs::path part = file.string() + kSuffix;
  std::error_code error;
  if (is_complete(part, ending)) {
    fs::rename(part, file, error);
    if (!error) return true;
  }
  fs::remove(part, error);
  return false;
}

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
  std::vector<std::string> arguments = {program, "-e", fmt::format("suffix = '{}'", kSuffix)};
  for (const DrawnFigure& figure : figures) {
    const std::string& id = figure.source->id;
    write_file_atomically(directory / (id + ".dat"), gnuplot_data(figure));
    write_file_atomically(directory / (id + ".gp"), gnuplot_script(figure));
    arguments.push_back(id + ".gp");
  }
  const ProcessOutcome outcome = run_process(arguments, directory);
  std::vector<std::string> missing;
  for (const DrawnFigure& figure : figures) {
    const fs::path stem = directory / figure.source->id;
    for (const auto& [extension, ending] : kFormats) {
      if (!publish(stem.string() + extension, ending)) {
        missing.push_back(figure.source->id + extension);
      }
    }
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
