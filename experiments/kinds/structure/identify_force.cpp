#include <algorithm>
#include <array>
#include <cmath>

#include "experiments/kinds/lint.hpp"
#include "experiments/kinds/structure/structure_kinds.hpp"
#include "experiments/report/result.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

using report::Series;

struct Shape {
  ForceShape shape;
  std::string_view name;
};
constexpr std::array kShapes = {Shape{ForceShape::kAuto, "auto"},
                                Shape{ForceShape::kImpacts, "impacts"},
                                Shape{ForceShape::kSmooth, "smooth"}};

std::string_view name_of(ForceShape shape) {
  return std::ranges::find(kShapes, shape, &Shape::shape)->name;
}

// Against the force that was measured, in the window.
struct ForceScore {
  double correlation = 0.0;
  double relative_error = 0.0;
  double in_band = 0.0;   // the same between the table's limits
  double coverage = 0.0;  // of the 95 % band
};

ForceScore score_of(const StructureForce& found, const std::vector<double>& measured, double rate,
                    const StructureTable& table) {
  const std::size_t count = found.force.size();
  std::vector<double> error(count),
      reference(measured.begin(), measured.begin() + static_cast<std::ptrdiff_t>(count));
  double ff = 0.0, rr = 0.0, fr = 0.0, ee = 0.0, inside = 0.0;
  for (std::size_t j = 0; j < count; ++j) {
    error[j] = found.force[j] - reference[j];
    ff += found.force[j] * found.force[j];
    rr += reference[j] * reference[j];
    fr += found.force[j] * reference[j];
    ee += error[j] * error[j];
    inside += std::abs(error[j]) <= 1.959964 * found.deviation[j] ? 1.0 : 0.0;
  }
  const RealFft fft(count);
  const std::vector<Complex> error_bins = fft.forward(error), bins = fft.forward(reference);
  double error_power = 0.0, power = 0.0;
  for (std::size_t k = 0; k < bins.size(); ++k) {
    const double at = static_cast<double>(k) * rate / static_cast<double>(count);
    if (at < table.low || at > table.high) continue;
    error_power += std::norm(error_bins[k]);
    power += std::norm(bins[k]);
  }
  return {.correlation = fr / std::sqrt(ff * rr),
          .relative_error = std::sqrt(ee / rr),
          .in_band = std::sqrt(error_power / power),
          .coverage = inside / static_cast<double>(count)};
}

struct ForceOutcome {
  const LoadedStructureRecord& loaded;
  const StructureForce& found;
  const std::optional<ForceScore>& score;

  void visit(ResultVisitor& visitor) const {
    const double rate = loaded.record.sample_rate;
    visitor.list(
        {.key = "force", .table = "identified_force", .name = "Identified force"}, 1, {},
        [&](ResultVisitor& row, std::size_t) {
          double impulse = 0.0, peak = 0.0, squares = 0.0;
          for (std::size_t j = 0; j < found.force.size(); ++j) {
            impulse += found.force[j] / rate;
            if (std::abs(found.force[j]) > std::abs(peak)) peak = found.force[j];
            squares += found.deviation[j] * found.deviation[j];
          }
          row({.key = "shape"}, name_of(found.shape));
          row({.key = "peak_n", .name = "peak", .unit = "N"}, peak);
          row({.key = "impulse_ns", .name = "impulse", .unit = "N s"}, impulse);
          row({.key = "deviation_n", .name = "rms deviation", .unit = "N", .format = "{:.2g}"},
              std::sqrt(squares / static_cast<double>(found.force.size())));
          row({.key = "correlation", .name = "R", .format = "{:.4f}"},
              score ? std::optional(score->correlation) : std::nullopt);
          row({.key = "relative_error", .name = "relative rms error", .format = "{:.3f}"},
              score ? std::optional(score->relative_error) : std::nullopt);
          row({.key = "relative_error_in_band", .name = "in the band", .format = "{:.3f}"},
              score ? std::optional(score->in_band) : std::nullopt);
          row({.key = "coverage", .name = "in the 95 % band", .format = "{:.3f}"},
              score ? std::optional(score->coverage) : std::nullopt);
        });
    visitor.rows({.key = "sensors",
                  .table = "sensors",
                  .name = "Sensors",
                  .meaning = "rms of what the common force leaves of each response, over what the "
                             "table's scatter and noise expect, and over the response itself."},
                 found.sensor_misfit, [&](ResultVisitor& row, const double& misfit) {
                   const auto k = static_cast<std::size_t>(&misfit - found.sensor_misfit.data());
                   row({.key = "channel"}, loaded.names[k]);
                   row({.key = "misfit", .name = "left, as expected: 1", .format = "{:.2f}"},
                       misfit);
                   row({.key = "left", .name = "left of the response", .format = "{:.2g}"},
                       found.sensor_left[k]);
                 });
    visitor({.key = "contour_per_s"}, found.sigma);
    visitor({.key = "window_s"}, found.window);
    visitor({.key = "background"}, found.background);
    visitor({.key = "evidence_impacts"}, known(found.evidence_impacts));
    visitor({.key = "evidence_smooth"}, known(found.evidence_smooth));
    visitor({.key = "misfit"}, known(found.misfit));
  }
};

report::Figure force_figure(const LoadedStructureRecord& loaded, const StructureForce& found) {
  const double rate = loaded.record.sample_rate;
  Series identified{.label = "identified"};
  Series measured{.label = "measured", .color = report::ColorRole::kReference};
  for (std::size_t j = 0; j < found.force.size(); ++j) {
    const double at = static_cast<double>(j) / rate, half = 1.959964 * found.deviation[j];
    identified.add(at, found.force[j], found.force[j] - half, found.force[j] + half);
    if (!loaded.record.force.empty()) measured.add(at, loaded.record.force[j]);
  }
  report::Figure figure{.id = "force",
                        .title = "Force at the contact",
                        .caption = "Identified from the responses, with its 95 % band.",
                        .panels = {{.x = {.label = "time", .unit = "s"},
                                    .y = {.label = "force", .unit = "N"},
                                    .series = {std::move(identified)}}}};
  if (!measured.x.empty())
    figure.panels[0].series.insert(figure.panels[0].series.begin(), measured);
  return figure;
}

StructureTable refined_by(const BlindFit& fit, StructureTable table) {
  table.model = fit.model;
  for (std::size_t n = 0; n < table.model.poles.size(); ++n) {
    const auto i = static_cast<Eigen::Index>(2 * n);
    table.frequency_deviations[n] = std::sqrt(fit.covariance(i, i));
    table.damping_deviations[n] = std::sqrt(fit.covariance(i + 1, i + 1));
  }
  return table;
}

std::string sentence_of(const BlindFit& fit, const StructureTable& table) {
  std::vector<double> moved, deviations;
  for (std::size_t n = 0; n < table.model.poles.size(); ++n) {
    const auto i = static_cast<Eigen::Index>(2 * n);
    moved.push_back(std::abs(fit.change[i]));
    deviations.push_back(std::sqrt(fit.covariance(i, i)));
  }
  return fmt::format(
      "modes refined without the force: median change of a frequency {:.2g}, its deviation {:.2g}; "
      "reduced chi2 {:.3f} of {:.0f} degrees of freedom\n",
      quantile(moved, 0.5), quantile(deviations, 0.5), fit.misfit, fit.degrees);
}

// Sensors that contradict each other refuse the answer.
void doubt(const StructureForce& found, const LoadedStructureRecord& loaded, StudyResult& result) {
  if (loaded.kinds.size() == 1) {
    result.warn(
        "one response explains any model: nothing tells whether the table is that of this "
        "structure; "
        "record a second sensor");
    return;
  }
  const auto worst = std::ranges::max_element(found.sensor_left);
  double power = 0.0;
  for (const double left : found.sensor_left) power += left * left;
  // A force alone, with no model at all, explains one of K responses.
  if (power < 0.25 * static_cast<double>(loaded.kinds.size() - 1)) return;
  result.status = report::Status::kFailed;
  result.warn(
      result.answer = fmt::format(
          "rejected: no force explains the responses together, {:.0f} % of {} is left: compare "
          "order, "
          "sign and unit of the channels and the place of the contact with those of the table",
          100.0 * *worst,
          loaded.names[static_cast<std::size_t>(worst - found.sensor_left.begin())]));
}

}  // namespace

void StructureChangeOptions::visit(OptionVisitor& visitor) {
  visitor("frequency", "relative standard deviation of every frequency",
          {.range = Range::open(0.0, 0.1)}, frequency);
  visitor("damping", "relative standard deviation of every damping ratio",
          {.range = Range::open(0.0, 2.0)}, damping);
  visitor("residue", "relative standard deviation of every modal constant; 0: known",
          {.range = Range::closed(0.0, 1.0)}, residue);
}

void IdentifyForceOptions::visit(OptionVisitor& visitor) {
  visitor("table", "file of the modes, as fit_modes writes it; relative to the experiment's folder",
          {.required = true}, table);
  visitor("record",
          "responses from rest, in the order of the table's sensors; a force is only "
          "compared with",
          {.required = true}, record);
  visitor("shape",
          "impacts: pulses of the table's shape at few instants; smooth: a force that never stops; "
          "auto: the one of larger evidence",
          {.choices = {"auto", "impacts", "smooth"}}, shape);
  visitor("non_negative", "pulses that only press", non_negative);
  visitor("window", "the force acts from the start on, so long; automatic: as long as the record",
          {.unit = "s", .range = Range::positive(), .word = "automatic"}, window);
  visitor("contour", "the record is weighted by exp(-contour t); automatic: 2 over the window",
          {.unit = "1/s", .range = Range::positive(), .word = "automatic"}, contour);
  visitor("change",
          "the structure may have changed since its table was made: its modes are refined by the "
          "responses first, without their force; needs two sensors and more",
          refines, change);
  visitor("draws", "models drawn from the table's deviations for the band",
          {.range = Range::closed(2.0, 1000.0)}, draws);
  visitor("seed", "key of the draws", {.range = Range::non_negative()}, seed);
  visitor("write_sound", "write the force as a sound file as well, identified.wav: 1.0 is 1 N",
          write_sound);
}

std::vector<Finding> IdentifyForceOptions::lint() const { return lint_structure_record(record); }

std::vector<Finding> IdentifyForceOptions::lint_records(const std::filesystem::path& folder) const {
  std::vector<Finding> findings;
  std::size_t sensors = 0;
  std::vector<SensorKind> kinds;
  lint_making(findings, "table", [&] { kinds = read_table(folder / table).model.sensors; });
  lint_making(findings, "record", [&] {
    const LoadedStructureRecord loaded = load_structure_record(record, folder);
    sensors = loaded.kinds.size();
    if (write_sound) lint_sound("write_sound", loaded.record.sample_rate, findings);
    if (kinds.empty()) return;
    MODCAL_REQUIRE(sensors == kinds.size(),
                   "{} responses for a table of {} sensors: name the same channels in its order",
                   sensors, kinds.size());
    for (std::size_t k = 0; k < sensors; ++k) {
      MODCAL_REQUIRE(loaded.kinds[k] == kinds[k], "response {} is {}, in the table {}", k + 1,
                     name_of(loaded.kinds[k]), name_of(kinds[k]));
    }
    MODCAL_REQUIRE(std::isnan(window) || window <= loaded.record.duration(),
                   "window = {:g} s is longer than the record, {:g} s", window,
                   loaded.record.duration());
  });
  return findings;
}

std::vector<PlanLine> IdentifyForceOptions::plan() const {
  return {{fmt::format("identify the force from {} responses of {} by the modes of {}",
                       record.responses.size(), record.file, table),
           {{"responses", record.responses.size()}, {"record", record.file}, {"table", table}}}};
}

StudyResult IdentifyForceOptions::run(const StudyContext& context) const {
  const StructureTable modes = read_table(context.folder / table);
  const LoadedStructureRecord loaded = load_structure_record(record, context.folder);
  context.throw_if_interrupted();
  const StructureForce found =
      structure_force(modes, loaded.record,
                      {.shape = std::ranges::find(kShapes, shape, &Shape::name)->shape,
                       .non_negative = non_negative,
                       .window = window,
                       .sigma = contour,
                       .draws = static_cast<std::size_t>(draws),
                       .seed = static_cast<std::uint64_t>(seed),
                       .change = refines ? std::optional<StructureChange>(change) : std::nullopt});
  std::optional<ForceScore> score;
  const double rate = loaded.record.sample_rate;
  if (!loaded.record.force.empty()) score = score_of(found, loaded.record.force, rate, modes);
  StudyResult result;
  const ForceOutcome outcome{loaded, found, score};
  result.summary = fmt::format("{} from {} sensors\n",
                               found.shape == ForceShape::kImpacts ? "impacts" : "a smooth force",
                               loaded.kinds.size());
  if (score) {
    result.summary += fmt::format(
        "against the measured force: relative rms error {:.3f}, {:.3f} between {:g} and {:g} Hz, R "
        "{:.4f}; {:.1f} % in the 95 % band\n",
        score->relative_error, score->in_band, modes.low, modes.high, score->correlation,
        100.0 * score->coverage);
  }
  if (found.refined) {
    result.summary += sentence_of(*found.refined, modes);
    result.files.emplace_back("table.yaml", table_text(refined_by(*found.refined, modes)));
  }
  result.answer_by_summary();
  for (const std::string& text : loaded.warnings) result.warn(text);
  doubt(found, loaded, result);
  if (!context.numbers_alone) result.blocks.emplace_back(force_figure(loaded, found));
  result.add(report::tables_of(outcome));
  result.files.emplace_back("force.json", report::json_file(report::json_of(outcome)));
  SignalFile file{"identified.csv", {{"f_c", "N", rate, found.force}}};
  file.signals.push_back({"f_c_deviation", "N", rate, found.deviation});
  if (write_sound) result.signal_files.push_back({"identified.wav", file.signals});
  result.signal_files.push_back(std::move(file));
  return result;
}

}  // namespace modcal
