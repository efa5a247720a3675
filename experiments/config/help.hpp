// Options described: as text and JSON for people, as a JSON schema for editors.
#pragma once

#include <nlohmann/json.hpp>

#include "experiments/config/document.hpp"
#include "libsim/base/options.hpp"

namespace modcal {

/// One entry per option: key, type, unit, default, range, choices, meaning, and the options of
/// groups. Nested plug-ins list their names.
nlohmann::ordered_json describe_options(const std::function<void(OptionVisitor&)>& visit);

/// The same as lines of text, indented by level.
std::string help_text(const nlohmann::ordered_json& options);

/// YAML with what its keys mean beside or above them, as `options` of describe_options() say it;
/// what has a comment keeps it.
std::string commented(const std::string& yaml, const nlohmann::ordered_json& options);

/// JSON schema (2020-12) of a map with these options; numbers may be texts with a unit.
nlohmann::ordered_json options_schema(const std::function<void(OptionVisitor&)>& visit);

/// The schema with what stands in it more than once under "$defs".
nlohmann::ordered_json with_shared_parts(nlohmann::ordered_json schema);

// Writes an options struct as YAML to paste and edit.

/// Visitor that writes `key: value  # meaning [unit]`, one option a line, indented by two blanks a
/// level. Optional groups that are absent are left out. A number without a value (NaN, no word)
/// stays empty: the reader asks for it.
class ResolvedWriter final : public OptionVisitor {
 public:
  const std::string& yaml() const { return yaml_; }

  void value(const OptionInfo& info, OptionValue value) override;
  void plugin(const OptionInfo& info, PluginSlot& slot) override;
  void group(const OptionInfo& info, const VisitMembers& visit_members) override;
  void optional_group(const OptionInfo& info, bool& present,
                      const VisitMembers& visit_members) override;
  void list(const OptionInfo& info, ListSlot& slot) override;
  void sweep(const OptionInfo& info, SweepSlot& slot) override;

 private:
  void line(const OptionInfo& info, const std::string& value, const std::string& note = {});

  std::size_t level_ = 0;
  std::string yaml_;
};

// Values on one line, as YAML writes them.

/// A text in YAML's double-quoted form, which is JSON's.
std::string yaml_string(const std::string& text);

/// A node on one line: 30 mm, [1, 2], {type: grid, points: 5}. A scalar stands as it was written.
std::string flow_text(const YamlNode& node);

}  // namespace modcal
