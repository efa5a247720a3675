// Writes an options struct as YAML to paste and edit.
#pragma once

#include "experiments/config/document.hpp"
#include "experiments/config/value_visitor.hpp"

namespace modcal {

/// Visitor that writes `key: value  # meaning [unit]`, one option a line, indented by two blanks a
/// level. Optional groups that are absent are left out. A number without a value (NaN, no word)
/// stays empty: the reader asks for it.
class ResolvedWriter final : public ValueVisitor {
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
  void line(const OptionInfo& info, const std::string& value);

  std::size_t level_ = 0;
  std::string yaml_;
};

// Values on one line, as YAML writes them.

/// YAML's double-quoted form, which is JSON's.
std::string yaml_string(const std::string& text);

/// Numbers, units and words as they were written; what would not read back so, in quotes.
std::string flow_scalar(const std::string& text);

/// A node on one line: 30 mm, [1, 2], {type: grid, points: 5}. A scalar stands as it was written.
std::string flow_text(const YamlNode& node);

}  // namespace modcal
