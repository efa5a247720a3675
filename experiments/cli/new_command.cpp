// new: an experiment file to start from.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <tuple>

#include "experiments/cli/command.hpp"
#include "experiments/config/help.hpp"
#include "experiments/config/reader.hpp"
#include "experiments/loader.hpp"
#include "experiments/memory.hpp"
#include "experiments/records/inspection.hpp"
#include "experiments/report/encoding.hpp"
#include "libinverse/waves/end_relation.hpp"
#include "libsim/base/files.hpp"
#include "libsim/records/levels.hpp"
#include "libsim/records/record_file.hpp"
#include "libsim/records/recording.hpp"

namespace modcal {
namespace {

struct NewArguments {
  std::string kind, record, out;
  std::string length, linear_density;
  double sample_rate = std::numeric_limits<double>::quiet_NaN();  // [Hz]
};

// A file of configs/ that shows a kind at its simplest.
struct ExampleFile {
  std::string_view kind, file;
};
constexpr ExampleFile kExampleFiles[] = {
    {"benchmark", "benchmark/optimizers.yaml"},
    {"calibrate", "beyond/calibrate_to_the_bound.yaml"},
    {"calibration_limit", "beyond/calibration_limit.yaml"},
    {"fit_modes", "structures/fit_plate.yaml"},
    {"identify", "calibration/pluck.yaml"},
    {"identify_force", "structures/force_on_plate.yaml"},
    {"invert", "beyond/friction_law.yaml"},
    {"pluck_then_bow", "paper/section7.yaml"},
    {"schelleng", "schelleng.yaml"},
    {"simulate", "scenes/thermal.yaml"},
    {"sweep", "beyond/joint_violin_d.yaml"},
};

constexpr double kViolin = 0.33;  // [m], where nobody states a length

double stated(const std::string& text, const char* option, const char* unit, double otherwise) {
  if (text.empty()) return otherwise;
  const ScalarNumber number = parse_number(text, unit);
  MODCAL_REQUIRE(number.error.empty(), "{}: {}", option, number.error);
  MODCAL_REQUIRE(number.value > 0.0, "{} {} must be > 0", option, text);
  return number.value;
}

// Files in experiments are relative to the folder of the experiment's file.
std::string seen_from(const std::string& out, const std::string& record) {
  if (out.empty()) return record;
  const auto folder = std::filesystem::absolute(out).parent_path();
  return std::filesystem::proximate(std::filesystem::absolute(record), folder).string();
}

void require_kind(const std::string& kind) {
  std::vector<std::string> kinds;
  for (const ExampleFile& example : kExampleFiles) kinds.emplace_back(example.kind);
  MODCAL_REQUIRE(std::ranges::count(kinds, kind) > 0, "unknown kind \"{}\"{}", kind,
                 suggestion(kind, kinds));
}

std::string example_of(const std::string& kind, const std::string& out) {
  for (const ExampleFile& example : kExampleFiles) {
    if (example.kind != kind) continue;
    const std::filesystem::path file = std::filesystem::path(shipped_configs()) / example.file;
    MODCAL_REQUIRE(std::filesystem::exists(file),
                   "{} is not there: install modcal with its configs", file.string());
    std::string text = content_of_file(file);
    for (const FileRead& read : load_experiment(file).experiment->files_read()) {
      const std::size_t at = text.find(": " + read.name);
      if (at == std::string::npos) continue;
      text.replace(at + 2, read.name.size(),
                   yaml_string(seen_from(out, file.parent_path() / read.name)));
    }
    Choice<Experiment> experiment;
    experiment.select(kind);
    return commented(text, describe_options([&experiment](OptionVisitor& visitor) {
                       experiment.visit_options(visitor);
                     }));
  }
  return {};
}

std::string channel_line(const char* end, const RecordedChannelOptions& force) {
  std::string keys = fmt::format("channel: {}", yaml_string(force.channel)), comment;
  if (!std::isnan(force.calibration)) {
    keys += ", calibration: 1";
    comment = "  # N per unit of the column: state yours";
  }
  if (force.turned) {
    keys += ", turned: true";
    comment += "  # or the other one's: a force > 0 pushes both below 0";
  }
  return fmt::format("  {}: {{{}}}{}\n", end, keys, comment);
}

std::string channel_lines(const RecordOptions& record) {
  std::string text = channel_line("left", record.left) + channel_line("right", record.right);
  if (record.has_reference) text += channel_line("reference", record.reference);
  if (record.has_reference_velocity) {
    text += channel_line("reference_velocity", record.reference_velocity);
  }
  if (record.has_reference_displacement) {
    text += channel_line("reference_displacement", record.reference_displacement);
  }
  return text;
}

ToldString told_by(const RecordOptions& record) {
  const RecordedSignals signals = load_record(record, ".");
  const std::span<const double> left = signals.left->samples, right = signals.right->samples;
  return find_string({.left = left,
                      .right = right,
                      .sample_rate = signals.sample_rate,
                      .noise = {white_noise_rms(left), white_noise_rms(right)}});
}

double length_of(const NewArguments& arguments, const ToldString& told) {
  const double length = stated(arguments.length, "--length", "m", kViolin);
  constexpr double kFastest = 5000.0;  // waves, 2 L f0 [m/s]: ten times those of a string
  MODCAL_REQUIRE(2.0 * length * told.fundamental < kFastest,
                 "--length {} is {:g} m, too long for a string of {:.4g} Hz: write its unit, as in "
                 "\"330 mm\"",
                 arguments.length, length, told.fundamental);
  return length;
}

// Left open where the record does not tell it: what is guessed would be believed.
std::string position_line(const ToldString& told, double length, const RecordOptions& record) {
  if (told.rival) {
    return fmt::format(
        "  position:  # fill in, from the end of {}: a pluck, or what rings by itself, does not "
        "tell it; {:.5g} or {:.5g} mm, or others\n",
        yaml_string(record.left.channel), 1e3 * told.contact * length, 1e3 * *told.rival * length);
  }
  return fmt::format(
      "  position: {:.5g} mm  # as the record has it: {:.4f} of the length from the end of {}\n",
      1e3 * told.contact * length, told.contact, yaml_string(record.left.channel));
}

// The experiment on a record of the string that its ends tell.
std::string text_for(const NewArguments& arguments, const ToldString& told,
                     const RecordOptions& record) {
  const double length = length_of(arguments, told);
  const double density = stated(arguments.linear_density, "--linear-density", "kg/m", 1e-3);
  const bool invert = arguments.kind == "invert";
  std::string text = fmt::format(
      "# {}\n"
      "kind: {}\n"
      "title: {}\n"
      "record:\n"
      "  file: {}\n",
      told.rival ? "State bow.position: the record does not tell it."
                 : "As it is, modcal run runs it.",
      arguments.kind, yaml_string(arguments.record),
      yaml_string(seen_from(arguments.out, arguments.record)));
  if (std::isfinite(arguments.sample_rate)) {
    text += fmt::format("  sample_rate: {:.15g} Hz\n", arguments.sample_rate);
  }
  text += channel_lines(record);
  text += fmt::format(
      "string:\n"
      "  length: {:.6g} m{}\n"
      "  linear_density: {:.6g} kg/m{}\n"
      "  fundamental: {:.6g} Hz  # as the record has it\n"
      "  inharmonicity: {:.3g}  # B of f_n = n f0 sqrt(1 + B n^2), as the record has it\n"
      "  damping: {{type: constant, ratio: 1e-3}}{}\n"
      "bow:\n",
      length,
      arguments.length.empty() ? "  # not in the record: state yours; positions go with it" : "",
      density,
      arguments.linear_density.empty()
          ? "  # not in the record: the motion goes with its inverse, the force does not"
          : "",
      told.fundamental, told.inharmonicity,
      invert ? "  # state yours, or calibrate first"
             : "  # a start: the calibration finds every mode's own");
  text += position_line(told, length, record);
  if (!invert) {
    text +=
        "# Supports that hold the string feel its bending, too, which a force is told by:\n"
        "# calibration: {reaction: support}  # tension: they do not; unsaid, the error bars hold "
        "both\n";
  }
  if (!told.explained) {
    text += "# The reactions are not quite those of one string: modcal validate says why.\n";
  }
  return text;
}

void require_both_ends(const InspectionReport& report, const std::string& file) {
  const RecordOptions& record = report.record;
  if (record.has_left && record.has_right) return;
  std::vector<std::string> names;
  for (const ChannelInspection& channel : report.channels) names.push_back(channel.name);
  const bool any = record.has_left || record.has_right;
  throw_invalid_input(
      "{}: {} of its channels ({}) is told to be a reaction{}: which string it is takes both; name "
      "them R1 and R2 in the file, or state the experiment by hand as `modcal inspect {}` shows",
      file, any ? "only one" : "none", fmt::join(names, ", "),
      any ? fmt::format(", {}", record.has_left ? record.left.channel : record.right.channel) : "",
      shell_word(file));
}

std::string file_for_record(const NewArguments& arguments) {
  MODCAL_REQUIRE(
      arguments.kind == "invert" || arguments.kind == "calibrate",
      "a record is read by the kinds invert and calibrate, not by {}: leave the record "
      "out, or name one of these; of a structure `modcal inspect {}` prints what to write",
      arguments.kind, shell_word(arguments.record));
  const InspectionReport report =
      inspect(arguments.record, {.sample_rate = arguments.sample_rate, .memory = machine_memory()});
  if (report.problem_count > 0) throw InvalidInput(with_rate_option(report.problems.front()));
  RecordOptions record = report.record;
  // Of a large file inspect reads the head alone; what follows reads all of it.
  require_memory(record.file, record.format, machine_memory());
  require_both_ends(report, arguments.record);
  ToldString told = told_by(record);
  // One sensor may read with the other sign.
  RecordOptions other = record;
  other.right.turned = true;
  const ToldString turned = told_by(other);
  // What rings by itself is explained by strings of other pitches, too, of either sign.
  const auto rank = [](const ToldString& string) {
    return std::tuple(string.explained, string.explained && string.near_pitch, -string.misfit);
  };
  if (rank(turned) > rank(told)) {
    told = turned;
    record = other;
  }
  return text_for(arguments, told, record);
}

ExitCode write_new(const NewArguments& arguments) {
  require_kind(arguments.kind);
  const std::string text = arguments.record.empty() ? example_of(arguments.kind, arguments.out)
                                                    : file_for_record(arguments);
  if (arguments.out.empty()) {
    say_text(text);
    return ExitCode::kOk;
  }
  MODCAL_REQUIRE(!std::filesystem::exists(arguments.out),
                 "{} exists and is not overwritten: name another file with --out", arguments.out);
  report::write_file_atomically(arguments.out, text);
  add_to_json("file", arguments.out);
  say("{0}\nmodcal run {1}\n", arguments.out, shell_word(arguments.out));
  return ExitCode::kOk;
}

void declare(CLI::App& command, NewArguments& arguments) {
  command.add_option("kind", arguments.kind, "kind of experiment, see modcal list experiment")
      ->required();
  CLI::Option* record =
      command.add_option("record", arguments.record,
                         "recorded file, of which the string and the contact point are read");
  // An example has a string of its own.
  command.add_option("--length", arguments.length, "vibrating length, \"0.33 m\"")->needs(record);
  command.add_option("--linear-density", arguments.linear_density, "mass per length, \"1 g/m\"")
      ->needs(record);
  declare_rate(command, arguments.sample_rate).needs(record);
  command.add_option("--out", arguments.out, "file to write; default: standard output")
      ->check(complaint_about_name);
}

}  // namespace

void add_new_command(CLI::App& app, const Chosen& chosen) {
  add_command(app, chosen, "new", "Write an experiment file to start from", declare, write_new);
}

}  // namespace modcal
