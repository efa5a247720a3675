// The file of a structure's modes.
#include <algorithm>
#include <cmath>

#include "experiments/config/help.hpp"
#include "experiments/config/reader.hpp"
#include "experiments/kinds/structure/structure_files.hpp"
#include "experiments/kinds/structure/table_columns.hpp"
#include "experiments/kinds/structure/table_functions.hpp"
#include "experiments/kinds/structure/table_shapes.hpp"
#include "experiments/runs/journal.hpp"
#include "experiments/study/fingerprint.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/turn.hpp"

namespace modcal {
namespace {

// The table as a file states it.
struct SensorOptions {
  std::string name, kind = "acceleration";
  ResidualTerms residual;
  SensorScatter scatter{.modal = std::numeric_limits<double>::quiet_NaN()};
  void visit(OptionVisitor& visitor) {
    visitor("name", "channel of the record it was fitted to", name);
    visitor("kind", "what it reads", {.required = true, .choices = sensor_kind_names()}, kind);
    visitor("below", "static term of the modes below the band", residual.below);
    visitor("constant", "static term of the modes above the band", residual.constant);
    visitor("scatter",
            "share of a mode's response, or of a measured function, by which the model may be off; "
            "automatic: 0.05, of functions of several sessions 0",
            {.range = Range::non_negative(), .word = "automatic"}, scatter.modal);
    visitor("noise", "standard deviation of a sample, in the sensor's SI unit",
            {.range = Range::non_negative()}, scatter.noise);
  }
};

struct TableOptions {
  std::vector<SensorOptions> sensors;
  std::vector<ModeOptions> modes;
  std::string modes_file;
  bool has_shapes = false, has_functions = false;
  ShapesOptions shapes;
  ResponseFunctionOptions functions;
  double low = 0.0, high = 0.0, pulse_step = 0.0;
  std::vector<double> contact, pulse;
  void visit(OptionVisitor& visitor) {
    visitor("low", "least frequency of the band",
            {.unit = "Hz", .range = Range::positive(), .required = true}, low);
    visitor("high", "largest frequency of the band",
            {.unit = "Hz", .range = Range::positive(), .required = true}, high);
    visitor("sensors", "in the order of the record's responses; functions tell them by themselves",
            sensors);
    visitor("modes", "pairs of poles with a modal constant a sensor", modes);
    visitor("modes_file",
            "CSV file of the modes, a row each, in the place of modes: frequency [Hz], "
            "damping_ratio and the constants of every sensor by its name; relative to the table's "
            "folder",
            modes_file);
    visitor("shapes", "modes of a universal file (UFF 55) in the place of modes", has_shapes,
            shapes);
    visitor("functions", "measured response functions in the place of modes", has_functions,
            functions);
    visitor(
        "contact",
        "phi^2/m of every mode where the force acts [1/kg], what a sensor of displacement there "
        "has for a constant; none: not known",
        contact);
    visitor("pulse_step", "between the magnitudes of pulse", {.unit = "Hz"}, pulse_step);
    visitor("pulse", "spectrum of a pulse of the force at 0, pulse_step, …, 1 at 0 Hz", pulse);
  }
};

void require_contact(const TableOptions& options, const std::string& file) {
  MODCAL_REQUIRE(options.contact.empty() || !options.has_functions,
                 "{}: contact is of modes, functions have none: leave it out", file);
  MODCAL_REQUIRE(options.contact.empty() || options.contact.size() == options.modes.size(),
                 "{}: contact has {} values for {} modes{}", file, options.contact.size(),
                 options.modes.size(), options.has_shapes ? ": shapes tell them" : "");
  MODCAL_REQUIRE(std::ranges::all_of(options.contact, [](double x) { return x >= 0.0; }),
                 "{}: contact holds squares over masses, which are >= 0", file);
}

void take_modes(const TableOptions& options, const std::string& file, StructureTable& table) {
  for (std::size_t n = 0; n < options.modes.size(); ++n) {
    const ModeOptions& mode = options.modes[n];
    const bool real = mode.quadrature.empty();
    MODCAL_REQUIRE(mode.constants.size() == options.sensors.size() &&
                       (real || mode.quadrature.size() == options.sensors.size()),
                   "{}: modes.{} has {} constants and {} quadratures for {} sensors", file, n,
                   mode.constants.size(), mode.quadrature.size(), options.sensors.size());
    table.model.poles.push_back({kTurn * mode.frequency, mode.ratio});
    table.frequency_deviations.push_back(mode.frequency_sd);
    table.damping_deviations.push_back(mode.ratio_sd);
  }
  for (std::size_t k = 0; k < options.sensors.size(); ++k) {
    for (const ModeOptions& mode : options.modes) {
      table.model.constants.push_back(mode.constants[k]);
      table.model.quadrature.push_back(mode.quadrature.empty() ? 0.0 : mode.quadrature[k]);
    }
  }
}

// A sensor that no mode moves tells nothing, and leaves nothing to divide by.
void require_motion(const StructureTable& table, const std::string& file) {
  const ModalModel& model = table.model;
  const std::size_t modes = model.poles.size();
  for (std::size_t k = 0; k < model.sensors.size(); ++k) {
    bool moves = model.residuals[k] != ResidualTerms{};
    for (std::size_t i = k * modes; i < (k + 1) * modes; ++i) {
      moves = moves || model.constants[i] != 0.0 ||
              (!model.quadrature.empty() && model.quadrature[i] != 0.0);
    }
    MODCAL_REQUIRE(moves,
                   "{}: the modal constants of {} are 0 in every mode: no force at the contact "
                   "moves it; check the columns, or nodes and directions of contact and sensors",
                   file, table.names[k]);
  }
}

StructureTable table_of(TableOptions options, const std::filesystem::path& path) {
  const std::string file = path.string();
  MODCAL_REQUIRE(options.low < options.high, "{}: low = {:g} Hz is not below high = {:g} Hz", file,
                 options.low, options.high);
  MODCAL_REQUIRE(options.pulse.empty() || options.pulse_step > 0.0,
                 "{}: pulse needs a positive pulse_step, not {:g} Hz", file, options.pulse_step);
  const bool has_file = !options.modes_file.empty();
  MODCAL_REQUIRE((options.modes.empty() ? 0 : 1) + (has_file ? 1 : 0) +
                         (options.has_shapes ? 1 : 0) + (options.has_functions ? 1 : 0) ==
                     1,
                 "{}: state modes, modes_file, shapes or functions, one of them", file);
  if (has_file) {
    std::vector<std::string> names;
    for (const SensorOptions& sensor : options.sensors) names.push_back(sensor.name);
    ModeColumns read = read_mode_columns(path.parent_path() / options.modes_file, names);
    options.modes = std::move(read.modes);
    MODCAL_REQUIRE(options.contact.empty() || read.contact.empty(),
                   "{}: contact is stated here and is a column of {}: keep one", file,
                   options.modes_file);
    if (options.contact.empty()) options.contact = std::move(read.contact);
  }
  require_contact(options, file);
  StructureTable table{
      .low = options.low, .high = options.high, .lag = options.pulse_step, .pulse = options.pulse};
  table.contact = options.contact;
  for (const SensorOptions& sensor : options.sensors) {
    table.names.push_back(sensor.name);
    table.model.sensors.push_back(sensor_kind_of(sensor.kind));
    table.model.residuals.push_back(sensor.residual);
    table.scatters.push_back(sensor.scatter);
    double& scatter = table.scatters.back().modal;
    if (std::isnan(scatter)) scatter = scatter_untold(options.functions.sessions);
  }
  if (options.has_functions) {
    take_functions(options.functions, path, table);
    return table;
  }
  MODCAL_REQUIRE(!options.sensors.empty(), "{}: sensors names none: state kind and name of each",
                 file);
  if (options.has_shapes) {
    take_shapes(options.shapes, path, table);
  } else {
    take_modes(options, file, table);
  }
  require_motion(table, file);
  return table;
}

TableOptions read_table_options(const std::filesystem::path& path) {
  const YamlDocument document = read_yaml_file(path);
  TableOptions options;
  std::vector<Mistake> mistakes = document.mistakes;
  if (mistakes.empty()) {
    read_options(
        document.root, [&](OptionVisitor& visitor) { options.visit(visitor); }, mistakes);
  }
  if (!mistakes.empty()) throw InvalidInput(format_mistakes(document, mistakes));
  return options;
}

std::vector<std::filesystem::path> read_names(const std::filesystem::path& path) {
  std::vector<std::filesystem::path> files;
  try {
    const TableOptions options = read_table_options(path);
    std::vector<std::string> named = {options.modes_file, options.shapes.file};
    std::ranges::copy(options.functions.files(), std::back_inserter(named));
    for (const std::string& file : named) {
      if (!file.empty()) files.push_back(path.parent_path() / file);
    }
  } catch (const InvalidInput&) {
    // The lint tells it at its place.
  }
  return files;
}

}  // namespace

std::string table_text(const StructureTable& table) {
  TableOptions options{.low = table.low,
                       .high = table.high,
                       .pulse_step = table.lag,
                       .contact = table.contact,
                       .pulse = table.pulse};
  const std::size_t modes = table.model.poles.size();
  for (std::size_t k = 0; k < table.model.sensors.size(); ++k) {
    options.sensors.push_back({.name = table.names[k],
                               .kind = std::string(name_of(table.model.sensors[k])),
                               .residual = table.model.residuals[k],
                               .scatter = table.scatters[k]});
  }
  for (std::size_t n = 0; n < modes; ++n) {
    ModeOptions& mode = options.modes.emplace_back();
    mode.frequency = table.frequency(n);
    mode.ratio = table.model.poles[n].zeta;
    mode.frequency_sd = table.frequency_deviations[n];
    mode.ratio_sd = table.damping_deviations[n];
    for (std::size_t k = 0; k < options.sensors.size(); ++k) {
      mode.constants.push_back(table.model.constant(k, n));
      mode.quadrature.push_back(table.model.quadrature[k * modes + n]);
    }
  }
  ResolvedWriter writer;
  options.visit(writer);
  return writer.yaml();
}

StructureTable read_table(const std::filesystem::path& path) {
  return table_of(read_table_options(path), path);
}

std::vector<std::filesystem::path> files_named_by_table(const std::filesystem::path& path) {
  // Of a list every task asks.
  static ComputedOnce<std::vector<std::filesystem::path>> known;
  return known.get(path.string() + input_digest(path), [&] { return read_names(path); });
}

}  // namespace modcal
