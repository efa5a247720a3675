#include "experiments/cli/command.hpp"

#include <cstdio>

#include "experiments/cli/terminal.hpp"
#include "experiments/report/encoding.hpp"

namespace modcal {

ExitCode guarded(const Action& action) {
  try {
    return action();
  } catch (const InvalidInput& error) {
    fmt::print(stderr, "{} {}\n", colored("error:"), error.what());
    return ExitCode::kInvalidInput;
  } catch (const Interrupted&) {
    return ExitCode::kInterrupted;
  } catch (const std::exception& error) {
    fmt::print(stderr, "internal error: {}\nPlease report it with the file and the command.\n",
               error.what());
    return ExitCode::kInternal;
  }
}

std::string shell_word(const std::string& text) {
  const std::string_view harmless =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-/=+:,%";
  if (!text.empty() && text.find_first_not_of(harmless) == std::string::npos) return text;
  return report::quoted(text, '\'', "'\\''");
}

void ExperimentArguments::declare_file(CLI::App& command) {
  command.add_option("file", file, "YAML file")->required();
  command.add_option("--set", assignments, "key.path=value, overrides the file")
      ->allow_extra_args(false);
}

void ExperimentArguments::declare_out(CLI::App& command, const std::string& seen_by) {
  command.add_option("--out", out,
                     fmt::format("folder of the results{}{}; default out/<name of the file>",
                                 seen_by.empty() ? "" : ", seen by all ", seen_by));
}

std::filesystem::path ExperimentArguments::folder() const {
  return out.empty() ? std::filesystem::path("out") / std::filesystem::path(file).stem()
                     : std::filesystem::path(out);
}

std::string ExperimentArguments::assignment_words() const {
  std::string words;
  for (const std::string& assignment : assignments) words += " --set " + shell_word(assignment);
  return words;
}

std::string ExperimentArguments::command() const {
  return fmt::format("modcal run {} --out {}{}{}", shell_word(file), shell_word(folder().string()),
                     assignment_words(),
                     threads > 0 ? fmt::format(" --threads {}", threads) : std::string());
}

void declare_threads(CLI::App& command, int& threads, const char* meaning) {
  command.add_option("--threads", threads, meaning)->check(CLI::Range(1, 4096));
}

std::optional<LoadedExperiment> load_and_print_mistakes(
    const std::filesystem::path& file, const std::vector<std::string>& assignments) {
  std::optional<LoadedExperiment> loaded = load_experiment(file, assignments);
  fmt::print(stderr, "{}", colored(format_mistakes(loaded->document, loaded->mistakes)));
  if (loaded->has_errors()) loaded.reset();
  return loaded;
}

void print_json(const nlohmann::ordered_json& object) {
  fmt::print("{}\n", object.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace modcal
