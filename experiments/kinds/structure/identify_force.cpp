#include <algorithm>
#include <cmath>

#include "experiments/kinds/structure/force_doubts.hpp"
#include "experiments/kinds/structure/force_outcome.hpp"
#include "experiments/kinds/structure/refined_modes.hpp"
#include "experiments/kinds/structure/structure_kinds.hpp"
#include "experiments/report/result.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

std::string sentence_of(const StructureForce& found, const LoadedStructureRecord& loaded) {
  const std::size_t at = told_peak(found);
  const StructureRecord& record = loaded.record;
  return fmt::format(
      "{} from {} sensors: at most {:.4g} +- {:.2g} N (95 %), at {:.4g} s{}{}\n",
      found.shape == ForceShape::kImpacts ? "impacts" : "a smooth force", loaded.kinds.size(),
      found.force[at], 1.959964 * found.deviation[at], static_cast<double>(at) / record.sample_rate,
      found.weak_until > 0.0 ? fmt::format("; below a tenth of that from {:.3g} to {:.3g} s",
                                           found.window, found.weak_until)
                             : "",
      found.rang ? "; what rang before the record or goes on behind it is taken out" : "");
}

std::string sentence_of(const ForceScore& score, const StructureTable& modes) {
  return fmt::format(
      "against the measured force: relative rms error {:.3f}, {:.3f} between {:g} and {:g} Hz, R "
      "{:.4f}; {:.1f} % in the 95 % band, {:.1f} % of what lies above {:g} Hz\n",
      score.relative_error, score.in_band, modes.low, modes.high, score.correlation,
      100.0 * score.coverage, 100.0 * score.coverage_above, modes.low);
}

std::string sentences_of(const ForceOutcome& outcome, const StructureTable& modes,
                         bool modes_first) {
  const std::string of_modes = outcome.refined ? outcome.refined->sentence() : "";
  std::string text = modes_first ? of_modes : "";
  for (const ContactForce& contact : outcome.forces) {
    if (outcome.forces.size() > 1) text += contact.table + ": ";
    text += sentence_of(contact.found, outcome.loaded);
    if (contact.score) text += sentence_of(*contact.score, modes);
  }
  return modes_first ? text : text + of_modes;
}

// What the answer says of the contacts behind the first.
std::string further_answer(const ForceOutcome& outcome) {
  std::string text;
  for (std::size_t p = 1; p < outcome.forces.size(); ++p) {
    const ContactForce& contact = outcome.forces[p];
    text += fmt::format("; {}: {}", contact.table, sentence_of(contact.found, outcome.loaded));
    text.pop_back();
  }
  return text;
}

// f_c, of further contacts f_c2, f_c3 and so on.
void add_signals(const std::vector<ContactForce>& forces, double rate, bool as_sound,
                 StudyResult& result) {
  SignalFile file{"identified.csv", {}};
  for (std::size_t p = 0; p < forces.size(); ++p) {
    const std::string name = p == 0 ? "f_c" : fmt::format("f_c{}", p + 1);
    file.signals.push_back({name, "N", rate, forces[p].found.force});
    file.signals.push_back({name + "_deviation", "N", rate, forces[p].found.deviation});
  }
  if (as_sound) result.signal_files.push_back({"identified.wav", file.signals});
  result.signal_files.push_back(std::move(file));
}

void tell_places(const PlacesOutcome& told, bool rang, StudyResult& result) {
  result.summary += told.sentence();
  result.add(report::tables_of(told));
  if (!rang) return;
  result.warn(
      "the places are weighed as if the structure rested when the record began: what rang before "
      "counts for the place where that was struck");
}

// The record of the other sensors; returns the name of the one that was left out.
std::string leave_out(std::size_t odd, LoadedStructureRecord& loaded) {
  const auto at = static_cast<std::ptrdiff_t>(odd);
  std::string name = loaded.names[odd];
  loaded.names.erase(loaded.names.begin() + at);
  loaded.kinds.erase(loaded.kinds.begin() + at);
  loaded.record.responses.erase(loaded.record.responses.begin() + at);
  return name;
}

void tell_left_out(const std::string& name, bool places, StudyResult& result) {
  if (name.empty()) return;
  std::string text = fmt::format("{} contradicts the other sensors, which agree without it", name);
  constexpr std::string_view kRemedy =
      "look for a gap, a gain, a delay, another sign or noise in it";
  if (!places) return result.warn(fmt::format("{}: it is left out; {}", text, kRemedy));
  result.status = report::Status::kFailed;
  result.answer = fmt::format(
      "rejected: {}, and the places are weighed by all of them: {}, or fit "
      "the tables without it",
      text, kRemedy);
  result.warn(result.answer);
}

}  // namespace

void StructureChangeOptions::visit(OptionVisitor& visitor) {
  visitor("frequency", "relative standard deviation of every frequency",
          {.range = Range::open(0.0, 0.1)}, frequency);
  visitor("damping", "relative standard deviation of every damping ratio",
          {.range = Range::open(0.0, 2.0)}, damping);
  visitor("residue",
          "standard deviation of every modal constant, over its size or, near a node, over what is "
          "usual of the mode; 0: known",
          {.range = Range::closed(0.0, 1.0)}, residue);
  visitor("coupling",
          "what changes frequencies by e turns the shapes of two modes df apart into each other by "
          "coupling e f/df: constants that are not known may be off by that, too; 0: none",
          {.range = Range::closed(0.0, 1.0)}, coupling);
}

void IdentifyForceOptions::visit_keys(OptionVisitor& visitor) {
  visitor("table", "file of the modes, as fit_modes writes it; relative to the experiment's folder",
          {.required = true}, table);
  visitor("other_places",
          "tables of the same structure and sensors with the contact elsewhere: the responses tell "
          "where the force acts; needs two sensors and more",
          other_places);
  visitor("record",
          "responses in the order of the table's sensors; a force is only "
          "compared with",
          {.required = true}, record);
  visitor(
      "shape",
      "impacts: pulses of the table's shape at few instants; smooth: a force that never stops; "
      "auto: the one of larger evidence; smooth where the window has more than 4000 instants, or "
      "1000 and the force does not stand in peaks",
      {.choices = {"auto", "impacts", "smooth"}}, shape);
  visitor("non_negative", "pulses that only press", non_negative);
  visitor(
      "window",
      "the force acts from the start on, so long; automatic: until it stays below a tenth of its "
      "peak, and a quarter longer",
      {.unit = "s", .range = Range::positive(), .word = "automatic"}, window);
  visitor("contour", "the record is weighted by exp(-contour t); automatic: 2 over the window",
          {.unit = "1/s", .range = Range::positive(), .word = "automatic"}, contour);
  visitor(
      "change",
      "the structure may have changed since its table was made: its modes are refined by the "
      "responses first, without their force; needs two sensors and more. Where it is not stated "
      "and the sensors contradict the table, a change of the size that they tell is allowed for",
      refines, change);
  visitor("unchanged", "the structure is that of its table, whatever the sensors say", unchanged);
  visitor("draws", "models drawn from the table's deviations for the band",
          {.range = Range::closed(2.0, 1000.0)}, draws);
  visitor("write_sound", "write the force as a sound file as well, identified.wav: 1.0 is 1 N",
          write_sound);
}

void IdentifyForceOptions::visit(OptionVisitor& visitor) {
  visit_keys(visitor);
  visitor("other_contacts",
          "tables of the same structure and sensors driven at other contacts, where forces act as "
          "well: all are identified; needs more sensors than contacts",
          other_contacts);
  visitor("seed", "key of the draws", {.range = Range::non_negative()}, seed);
}

std::vector<std::string> IdentifyForceOptions::tables() const {
  std::vector<std::string> all = {table};
  all.insert(all.end(), other_places.begin(), other_places.end());
  all.insert(all.end(), other_contacts.begin(), other_contacts.end());
  return all;
}

std::vector<FileRead> IdentifyForceOptions::files_read() const {
  std::vector<FileRead> files;
  for (const std::string& file : tables()) {
    files.push_back({.name = file,
                     .key = files.empty()            ? "table"
                            : other_contacts.empty() ? "other_places"
                                                     : "other_contacts",
                     .named = files_named_by_table});
  }
  files.push_back(file_read(record));
  return files;
}

std::vector<PlanLine> IdentifyForceOptions::plan() const {
  const std::string what =
      other_contacts.empty() ? "the force"
                             : fmt::format("the forces at {} contacts", 1 + other_contacts.size());
  return {{fmt::format("identify {} from {} responses of {} by the modes of {}", what,
                       record.responses.size(), record.file, table),
           {{"responses", record.responses.size()}, {"record", record.file}, {"table", table}}}};
}

std::optional<ContactPlaces> IdentifyForceOptions::weighed(
    const std::vector<StructureTable>& places, const LoadedStructureRecord& loaded) const {
  if (other_places.empty()) return std::nullopt;
  // The longest part that any of the places asks for.
  double least = 0.0;
  ActingPart longest;
  for (const StructureTable& place : places) {
    const ActingPart part = acting_part(place, loaded.record, force_options(loaded));
    if (part.duration > longest.duration) longest = part;
    least = std::max(least, place.measured.grid.sigma);
  }
  const double sigma = std::isnan(contour) ? 2.0 / longest.duration : contour;
  return weigh_places(places, longest.of(loaded.record), std::max(sigma, least));
}

StructureForceOptions IdentifyForceOptions::force_options(
    const LoadedStructureRecord& loaded) const {
  return {.shape = force_shape_of(shape),
          .non_negative = non_negative,
          .window = window,
          .sigma = contour,
          .rests = loaded.rest > 0.0,
          .quiet = loaded.quiet,
          .draws = static_cast<std::size_t>(draws),
          .seed = static_cast<std::uint64_t>(seed),
          .change = refines ? std::optional<StructureChange>(change) : std::nullopt,
          .may_have_changed = !unchanged && other_places.empty()};
}

StudyResult IdentifyForceOptions::found(const StudyContext& context, bool modes_first) const {
  LoadedStructureRecord loaded = load_structure_record(record, context.folder, context.stop);
  std::vector<std::string> names = tables();
  std::vector<StructureTable> contacts;
  for (const std::string& file : names) contacts.push_back(read_table(context.folder / file));
  const std::optional<ContactPlaces> where = weighed(contacts, loaded);
  if (where) {
    contacts = {contacts[where->best]};
    names = {names[where->best]};
  }
  share_band(contacts);
  context.throw_if_interrupted();
  std::vector<ContactForce> forces;
  for (StructureForce& found : structure_forces(contacts, loaded.record, force_options(loaded))) {
    forces.push_back({.table = names[forces.size()], .found = std::move(found)});
  }
  const StructureForce& force = forces.front().found;
  std::string odd;
  if (force.left_out) {
    odd = leave_out(*force.left_out, loaded);
    contacts.front() = contacts.front().without_sensor(*force.left_out);
  }
  const StructureTable& modes = contacts.front();
  const double rate = loaded.record.sample_rate;
  std::optional<ForceScore>& score = forces.front().score;
  if (!loaded.record.force.empty()) score = score_of(force, loaded.record.force, rate, modes);
  StudyResult result;
  std::optional<RefinedModes> refined;
  if (force.refined) refined.emplace(RefinedModes{modes, *force.refined});
  const ForceOutcome outcome{loaded, forces, odd, refined};
  result.summary = sentences_of(outcome, modes, modes_first);
  if (refined) {
    result.files.emplace_back("table.yaml", table_text(refined->after()));
    refined->add_parameters(result.parameters);
  }
  result.answer_by_summary();
  result.answer += further_answer(outcome);
  for (const std::string& text : loaded.warnings) result.warn(text);
  for (const StructureTable& table_of_one : contacts) {
    for (const std::string& text : table_of_one.warnings) result.warn(text);
  }
  tell_left_out(odd, where.has_value(), result);
  if (where) tell_places({tables(), *where}, force.rang, result);
  doubt_forces(forces, loaded, contacts, force_shape_of(shape), result);
  if (refined) {
    for (const std::string& text : refined->doubts()) result.warn(text);
  }
  if (!context.numbers_alone) {
    result.blocks.emplace_back(force_figure(loaded, forces));
    if (refined) {
      result.blocks.emplace_back(refined->figure());
      if (modes_first) std::iter_swap(result.blocks.end() - 1, result.blocks.end() - 2);
    }
  }
  result.add(report::tables_of(outcome));
  result.files.emplace_back("force.json", report::json_file(report::json_of(outcome)));
  add_signals(forces, rate, write_sound, result);
  return result;
}

}  // namespace modcal
