// Fills options from a YAML map, strictly: every key must be known, every required one be there,
// every value be of its kind, unit and range. All mistakes are collected, none is thrown.
#pragma once

#include <algorithm>
#include <map>

#include "experiments/config/document.hpp"
#include "libsim/base/options.hpp"

namespace modcal {

struct SweepTable;

class YamlReader final : public OptionVisitor {
 public:
  /// Reads from the map `node`; mistakes are appended to `mistakes`.
  YamlReader(const YamlNode& node, std::vector<Mistake>& mistakes);

  void value(const OptionInfo& info, OptionValue value) override;
  void plugin(const OptionInfo& info, PluginSlot& slot) override;
  void group(const OptionInfo& info, const VisitMembers& visit_members) override;
  void optional_group(const OptionInfo& info, bool& present,
                      const VisitMembers& visit_members) override;
  void list(const OptionInfo& info, ListSlot& slot) override;
  /// {product, zip, exclude, include}: every cell is read from this reader's map with its values
  /// put in.
  void sweep(const OptionInfo& info, SweepSlot& slot) override;

  /// A key that is read elsewhere.
  void allow(std::string_view key) {
    if (std::find(seen_.begin(), seen_.end(), key) == seen_.end()) seen_.emplace_back(key);
  }
  /// Keys that another reader of the same map has read or was told of.
  void allow_all_known(const YamlReader& other) {
    for (const std::string& key : other.seen_) allow(key);
  }
  /// Reports the keys that nobody asked for.
  void finish();

 private:
  const YamlNode* take(const OptionInfo& info);
  /// Says what a section that is left out would have needed.
  void skip_section(const OptionInfo& info, const VisitMembers& visit_members);
  void read_members(const YamlNode& node, const VisitMembers& visit_members,
                    std::string_view section);
  std::string remedy_of(const YamlNode::Member& member) const;
  void mistake(const YamlNode& node, std::string text);
  // False with a mistake where the node holds no such value.
  bool read(const OptionInfo& info, const YamlNode& node, double& value);
  bool read(const OptionInfo& info, const YamlNode& node, std::int64_t& value);
  bool read(const OptionInfo& info, const YamlNode& node, bool& value);
  bool read(const OptionInfo& info, const YamlNode& node, std::string& value);
  template <typename Value>
  bool read(const OptionInfo& info, const YamlNode& node, std::vector<Value>& values);
  bool select(const OptionInfo& info, const YamlNode& name, PluginSlot& slot);
  std::vector<Mistake> read_cell(const YamlNode& base, const SweepTable& table, std::size_t cell,
                                 SweepSlot& slot) const;
  void read_cells(std::string_view key, const SweepTable& table, SweepSlot& slot);

  const YamlNode& node_;
  std::vector<Mistake>& mistakes_;
  std::vector<std::string> seen_;
  std::vector<std::string> missing_;
  /// Keys of the sections that stand in the map, and their section.
  std::vector<std::pair<std::string, std::string>> inner_;
};

/// Reads a whole map with one visit and reports unknown keys; `allowed`: keys read elsewhere.
void read_options(const YamlNode& node, const std::function<void(OptionVisitor&)>& visit,
                  std::vector<Mistake>& mistakes, const std::vector<std::string>& allowed = {});

/// How a mistake ends that a decimal comma between commas has made.
inline constexpr std::string_view kDecimalComma = ": write a decimal point, not a comma";

/// Where the options of a key that was given up stand now; empty for other keys.
std::string_view moved_key(std::string_view key);
/// ", did you mean …?" or the list of names.
std::string suggestion(std::string_view text, const std::vector<std::string>& names);

// What mistakes in a configuration call things.

/// "a map", "a list", "a single value" or "nothing".
std::string_view kind_name(const YamlNode& node);

std::vector<std::string> strings_of(const std::vector<std::string_view>& views);

// Numbers with units, as people write them.

struct ScalarNumber {
  double value = 0.0;  ///< in the SI unit asked for
  std::string error;   ///< why there is no value; empty: there is one
};

/// "30 mm" in "m" is 0.03; a bare number is in the SI unit. "2 %" is allowed for pure numbers.
ScalarNumber parse_number(std::string_view text, std::string_view si_unit);

// The section "sweep" of an experiment: from axes to cells.

/// A sweep as written, with the places of its values.
struct SweepTable {
  SweepPlan plan;
  std::vector<std::string> paths;
  std::vector<SourcePosition> places;                ///< of the paths
  std::vector<std::vector<const YamlNode*>> values;  ///< of every cell; null: its own
  /// Places of the paths in the order in which their values are put in: a section before what lies
  /// in it.
  std::vector<std::size_t> order;
  SweepCells cells() const;
};

/// SweepTable::order of these paths.
std::vector<std::size_t> outer_first(const std::vector<std::string>& paths);

/// An axis below another one whose value states its key, and what stands in the list already of
/// the last `included` cells.
std::vector<Mistake> mistakes_of(const SweepTable& table, std::size_t included);

/// Reads {product, zip, exclude, include}; mistakes are appended, and with one of them the table is
/// empty. The nodes must outlive the table.
SweepTable read_sweep(const YamlNode& node, std::string_view key, std::vector<Mistake>& mistakes);

}  // namespace modcal
