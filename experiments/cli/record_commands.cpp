#include <cmath>

#include "experiments/cli/command.hpp"
#include "experiments/cli/runner.hpp"
#include "experiments/memory.hpp"
#include "experiments/records/inspection.hpp"
#include "libsim/records/formats.hpp"

namespace modcal {

CLI::Option& declare_rate(CLI::App& command, double& rate) {
  return *command
              .add_option("--sample-rate", rate, "such as \"44.1 kHz\", where the file has none")
              ->transform(hertz_of);
}

std::string with_rate_option(std::string text) {
  constexpr std::string_view kKey = "state sample_rate";
  const std::size_t at = text.find(kKey);
  return at == std::string::npos ? text : text.replace(at, kKey.size(), "state --sample-rate");
}

namespace {

std::string format_words() { return fmt::format("{}", fmt::join(record_format_choices(), ", ")); }

struct InspectArguments {
  std::string file;
  InspectionOptions options;
};

ExitCode print_inspection(const InspectArguments& arguments) {
  InspectionOptions options = arguments.options;
  options.memory = machine_memory();
  const InspectionReport report = inspect(arguments.file, options);
  if (answer_style().json) {
    print_json(json(report));
  } else {
    say_text(text(report));
  }
  return report.problem_count == 0 ? ExitCode::kOk : ExitCode::kInvalidInput;
}

void declare(CLI::App& command, InspectArguments& arguments) {
  command.add_option("file", arguments.file, "recorded file")->required();
  command.add_option("--format", arguments.options.format, format_words());
  command.add_flag("--headers", arguments.options.headers_only,
                   "read headers alone, or the first rows of what has none");
  declare_rate(command, arguments.options.sample_rate);
}

struct ConvertArguments {
  std::string from, to;
  std::string from_format = "auto", to_format = "auto";
  double sample_rate = std::numeric_limits<double>::quiet_NaN();
};

// In the unit that the file states; audio samples without one stay as they are.
Signal signal_of(RecordedChannel& channel, double sample_rate) {
  const bool scaled = std::isfinite(channel.full_scale) && channel.full_scale != 1.0;
  for (double& value : channel.samples) value *= scaled ? channel.full_scale : 1.0;
  return {channel.name, channel.unit, sample_rate, std::move(channel.samples)};
}

ExitCode convert_functions(const ConvertArguments& arguments) {
  FileFunctions all = read_functions(arguments.from, arguments.from_format);
  const std::size_t count = write_functions(arguments.to, arguments.to_format, all, version_text());
  for (const std::string& text : all.warnings) warn("{}", text);
  add_to_json("file", arguments.to);
  add_to_json("channels", count);
  const std::vector<double>& hertz = all.functions.front().hertz;
  say("{}: {} function{} of frequency, {} lines from {:g} to {:g} Hz\n", arguments.to, count,
      count == 1 ? "" : "s", hertz.size(), hertz.front(), hertz.back());
  return ExitCode::kOk;
}

Recording read_all(const ConvertArguments& arguments) {
  try {
    return read_record(arguments.from, arguments.from_format,
                       {.sample_rate = arguments.sample_rate, .memory = machine_memory()});
  } catch (const InvalidInput& error) {
    throw InvalidInput(with_rate_option(error.what()), error.place());
  }
}

ExitCode convert_record(const ConvertArguments& arguments, const RecordFormat& target) {
  MODCAL_REQUIRE(target.write != nullptr, "{}: files of the format {} are read only", arguments.to,
                 target.name);
  Recording recording = read_all(arguments);
  std::vector<Signal> signals;
  for (RecordedChannel& channel : recording.channels) {
    signals.push_back(signal_of(channel, recording.sample_rate));
  }
  for (const std::string& text : recording.warnings) warn("{}", text);
  if (target.begins_at_zero && std::abs(recording.start) > 0.0) {
    warn("{}: begins at 0; {} begins at {:.9g} s, for which {} files have no place", arguments.to,
         arguments.from, recording.start, target.name);
  }
  target.write(arguments.to, signals, {.provenance = version_text(), .start = recording.start});
  add_to_json("file", arguments.to);
  add_to_json("channels", signals.size());
  say("{}: {} channel{}, {} samples at {} Hz\n", arguments.to, signals.size(),
      signals.size() == 1 ? "" : "s", signals.front().size(), recording.sample_rate);
  return ExitCode::kOk;
}

ExitCode convert(const ConvertArguments& arguments) {
  const RecordFormat& target = record_format(arguments.to, arguments.to_format);
  std::error_code error;
  const auto status = std::filesystem::symlink_status(arguments.to, error);
  MODCAL_REQUIRE(!std::filesystem::exists(status),
                 "{}: something of this name stands there, and it is not replaced; choose another "
                 "name",
                 arguments.to);
  // A rate that is stated is one of a record in time.
  const bool is_in_time =
      std::isfinite(arguments.sample_rate) ||
      !has_functions_alone(arguments.from, arguments.from_format, machine_memory());
  return is_in_time ? convert_record(arguments, target) : convert_functions(arguments);
}

void declare(CLI::App& command, ConvertArguments& arguments) {
  command.add_option("from", arguments.from, "recorded file")->required();
  command.add_option("to", arguments.to, "file to write, which is not there yet")
      ->required()
      ->check(complaint_about_name);
  command.add_option("--from-format", arguments.from_format, format_words());
  command.add_option("--to-format", arguments.to_format, format_words());
  declare_rate(command, arguments.sample_rate);
}

}  // namespace

void add_record_commands(CLI::App& app, const Chosen& chosen) {
  add_command(app, chosen, "inspect", "Show what a recorded file holds and the YAML to use it",
              declare, print_inspection);
  add_command(app, chosen, "convert", "Write a recorded file in another format", declare, convert);
}

}  // namespace modcal
