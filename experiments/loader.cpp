#include "experiments/loader.hpp"

#include <algorithm>
#include <array>
#include <regex>
#include <set>
#include <tuple>

#include "experiments/config/help.hpp"
#include "experiments/config/reader.hpp"
#include "experiments/memory.hpp"

namespace modcal {
namespace {

// Position of the deepest existing part of a dotted path ("plucks.0.duration").
SourcePosition position_of_path(const YamlNode& root, std::string_view path) {
  const YamlNode* node = &root;
  SourcePosition position = root.position;
  while (!path.empty()) {
    const std::size_t dot = path.find('.');
    node = node->child(path.substr(0, dot));
    if (node == nullptr) break;
    position = node->position;
    if (dot == std::string_view::npos) break;
    path.remove_prefix(dot + 1);
  }
  return position;
}

// Where a list of tasks has a value of an axis; null: it is written elsewhere.
const YamlNode* value_of_axis(const YamlNode& node, const std::string& axis,
                              const std::string& value) {
  for (const YamlNode::Member& member : node.members) {
    const YamlNode& values = member.value;
    if (member.key != axis) {
      if (const YamlNode* found = value_of_axis(values, axis, value)) return found;
      continue;
    }
    for (const YamlNode& item : values.items) {
      if (item.text == value) return &item;
    }
  }
  return nullptr;
}

SourcePosition position_of_finding(const YamlNode& root, const Finding& finding) {
  const YamlNode* sweep = finding.axis.empty() ? nullptr : root.find("sweep");
  const YamlNode* value =
      sweep != nullptr ? value_of_axis(*sweep, finding.axis, finding.value) : nullptr;
  return value != nullptr ? value->position : position_of_path(root, finding.path);
}

bool choose_kind(LoadedExperiment& loaded) {
  const YamlNode* kind = loaded.document.root.find("kind");
  std::vector<std::string> names;
  for (const std::string_view name : loaded.choice.names()) names.emplace_back(name);
  if (kind == nullptr) {
    loaded.mistakes.push_back(
        {loaded.document.root.position, "missing key \"kind\"" + suggestion("", names)});
    return false;
  }
  if (std::find(names.begin(), names.end(), kind->text) == names.end()) {
    loaded.mistakes.push_back(
        {kind->position, kind->text.empty() ? "kind must be one word" + suggestion("", names)
                                            : fmt::format("unknown kind \"{}\"{}", kind->text,
                                                          suggestion(kind->text, names))});
    return false;
  }
  loaded.kind = kind->text;
  loaded.choice.select(kind->text);
  return true;
}

void visit_head(OptionVisitor& visitor, LoadedExperiment& loaded) {
  visitor("title", "title of the report", loaded.title);
  visitor("description", "what the experiment is for", loaded.description);
}

// Where mistakes stand, to be asked of every finding.
class Places {
 public:
  explicit Places(const std::vector<Mistake>& mistakes) {
    for (const Mistake& mistake : mistakes) add(mistake);
  }
  void add(const Mistake& mistake) {
    all_.insert(key_of(mistake.position));
    texts_.insert(mistake.text);
    if (mistake.text.starts_with("missing key")) missing_.insert(key_of(mistake.position));
  }
  bool known(const SourcePosition& position) const { return all_.contains(key_of(position)); }
  bool said(const std::string& text) const { return texts_.contains(text); }
  // What a list says of itself follows from an item that could not be read.
  bool has_wrong_item(const YamlNode& node) const {
    return std::ranges::any_of(node.items,
                               [this](const YamlNode& item) { return known(item.position); });
  }
  // What a section says of itself follows from a key that it lacks.
  bool lacks_a_key(const YamlNode& node) const {
    if (missing_.empty()) return false;
    return missing_.contains(key_of(node.position)) ||
           std::ranges::any_of(node.items,
                               [this](const YamlNode& item) { return lacks_a_key(item); }) ||
           std::ranges::any_of(node.members, [this](const YamlNode::Member& member) {
             return lacks_a_key(member.value);
           });
  }

 private:
  using Key = std::tuple<std::size_t, std::size_t, std::string>;
  static Key key_of(const SourcePosition& position) {
    return {position.line, position.column, position.origin};
  }
  std::set<Key> all_, missing_;
  std::set<std::string> texts_;
};

// The node at a dotted path; null: the file does not have it.
const YamlNode* node_at(const YamlNode& root, std::string_view path) {
  const YamlNode* node = &root;
  while (node != nullptr && !path.empty()) {
    const std::size_t dot = path.find('.');
    node = node->child(path.substr(0, dot));
    path.remove_prefix(dot == std::string_view::npos ? path.size() : dot + 1);
  }
  return node;
}

// A number prints as nan only where its option could not be read, which is a mistake already.
bool is_consequence(const std::string& text) {
  static const std::regex kNan("\\bnan\\b");
  return std::regex_search(text, kNan);
}

// Before a record is read. False where it is too much.
bool check_files(const Experiment& experiment, const Means& means, LoadedExperiment& loaded) {
  const std::vector<FileRead> files = experiment.files_read();
  const double needed = memory_of_files(experiment, loaded.document.folder(), means.threads);
  loaded.memory = std::max(loaded.memory, needed);
  const bool is_stated = means.memory > 0.0;
  const double most = is_stated ? means.memory : machine_memory();
  if (!(needed > most)) return true;
  const bool is_scene = files.front().numbers > 0.0;
  loaded.mistakes.push_back(
      {position_of_path(loaded.document.root, is_scene ? "structure.duration" : files.front().key),
       fmt::format("the run needs about {} of memory, {} {}, by {}, or more with --memory",
                   bytes_text(needed), is_stated ? "--memory allows" : "there are",
                   bytes_text(most),
                   is_scene ? "the samples of its scene; state a shorter one, a lower "
                              "measurement.sample_rate or structure.oversampling"
                            : "the size of its records; state a part with record.start and "
                              "record.stop of a shorter file")});
  return false;
}

// Before anything is made of that size. False where it is too much.
bool check_simulations(const Experiment& experiment, const Means& means, LoadedExperiment& loaded) {
  std::optional<PlannedSimulations> planned;
  try {
    planned = experiment.planned_simulations();
  } catch (const InvalidInput&) {
    return true;  // the lint says it at its place
  }
  if (!planned) return true;
  loaded.memory = memory_needed(experiment, means.threads);
  const bool is_stated = means.memory > 0.0;
  const double most = is_stated ? means.memory : machine_memory();
  const double duration = planned->truth.scene.duration;
  if (!(loaded.memory > most)) return true;
  loaded.mistakes.push_back(
      {position_of_path(loaded.document.root, "scene.duration"),
       fmt::format(
           "the run needs about {} of memory, {} {}: {:g} s at {:g} Hz make {:g} samples; "
           "shorten the record, lower measurement.sample_rate{} or state more with --memory",
           bytes_text(loaded.memory), is_stated ? "--memory allows" : "there are", bytes_text(most),
           duration, planned->sample_rate, std::round(duration * planned->sample_rate),
           planned->count > 1 ? ", take fewer --threads" : "")});
  return false;
}

bool check_memory(const Experiment& experiment, const Means& means, LoadedExperiment& loaded) {
  return check_simulations(experiment, means, loaded) && check_files(experiment, means, loaded);
}

// A table of modes where the kind has none.
void tell_of_structures(LoadedExperiment& loaded) {
  constexpr std::array<std::string_view, 5> kKeys = {"table", "structure", "model", "shapes",
                                                     "responses"};
  std::string_view what;
  for (Mistake& mistake : loaded.mistakes) {
    if (std::ranges::count(kKeys, mistake.unknown_key) == 0) continue;
    try {
      if (what.empty()) what = loaded.choice.make()->for_structures();
    } catch (const InvalidInput&) {
      return;  // what it cannot be made of is told by itself
    }
    mistake.text = fmt::format("unknown key \"{}\": {}", mistake.unknown_key, what);
  }
}

// Lints even where options are wrong, so that one look shows every mistake; what only follows from
// a wrong option is left out by the lint itself.
void make_and_lint(LoadedExperiment& loaded, const Means& means) {
  const YamlNode& root = loaded.document.root;
  const bool had_errors = loaded.has_errors();
  // Half of a number has been read in the place of it.
  if (std::ranges::any_of(loaded.mistakes, [](const Mistake& mistake) {
        return mistake.text.ends_with(kDecimalComma);
      })) {
    return;
  }
  try {
    auto experiment = loaded.choice.make();
    if (!had_errors && !check_memory(*experiment, means, loaded)) return;
    Places mistakes(loaded.mistakes);
    for (const Finding& finding : experiment->lint()) {
      const SourcePosition position = position_of_finding(root, finding);
      const YamlNode* node = node_at(root, finding.path);
      if (mistakes.said(finding.text)) continue;  // a simulator refuses what its scene does
      // Of a text that cannot be read on, what it lacks may follow.
      if (finding.path.empty() && !loaded.document.mistakes.empty()) continue;
      // What is only doubtful is told when all could be read.
      if (had_errors &&
          (!finding.is_error || mistakes.known(position) || is_consequence(finding.text) ||
           (node != nullptr && (mistakes.lacks_a_key(*node) || mistakes.has_wrong_item(*node))))) {
        continue;
      }
      loaded.mistakes.push_back({position, finding.text, !finding.is_error});
      mistakes.add(loaded.mistakes.back());
    }
    if (!loaded.has_errors()) loaded.experiment = std::move(experiment);
  } catch (const InvalidInput& error) {
    if (!had_errors) loaded.mistakes.push_back({root.position, error.what()});
  }
}

}  // namespace

bool LoadedExperiment::has_errors() const {
  return std::any_of(mistakes.begin(), mistakes.end(),
                     [](const Mistake& mistake) { return !mistake.warning; });
}

std::string LoadedExperiment::resolved() const {
  LoadedExperiment copy = *this;
  ResolvedWriter writer;
  std::string kind_name = kind;
  writer("kind", "kind of experiment", {.choices = {kind_name}}, kind_name);
  visit_head(writer, copy);
  copy.choice.visit_options(writer);
  return writer.yaml();
}

LoadedExperiment load_experiment(YamlDocument document, const Means& means) {
  LoadedExperiment loaded;
  loaded.document = std::move(document);
  loaded.mistakes = loaded.document.mistakes;
  if (loaded.document.root.kind != YamlNode::Kind::kMap) return loaded;
  if (!choose_kind(loaded)) return loaded;
  read_options(loaded.document.root,
               [&loaded](OptionVisitor& visitor) {
                 visit_head(visitor, loaded);
                 loaded.choice.visit_options(visitor);
               },
               loaded.mistakes, {"kind"});
  // Where the text cannot be read on, nothing is known of what follows.
  if (!loaded.document.mistakes.empty()) {
    std::erase_if(loaded.mistakes,
                  [](const Mistake& mistake) { return mistake.text.starts_with("missing key"); });
  }
  tell_of_structures(loaded);
  make_and_lint(loaded, means);
  return loaded;
}

void check_records(LoadedExperiment& loaded) {
  if (!loaded.experiment) return;
  for (const Finding& finding : loaded.experiment->lint_records(loaded.document.folder())) {
    loaded.mistakes.push_back(
        {position_of_finding(loaded.document.root, finding), finding.text, !finding.is_error});
  }
}

LoadedExperiment load_experiment(const std::filesystem::path& file,
                                 const std::vector<std::string>& assignments, const Means& means) {
  YamlDocument document = read_yaml_file(file);
  for (std::size_t i = 0; i < assignments.size(); ++i) {
    apply_assignment(document, assignments[i], i + 1);
  }
  return load_experiment(std::move(document), means);
}

}  // namespace modcal
