// How every plug-in and every section of an experiment describes its options: one visit() that
// names key, unit, range, default and meaning in one place. The YAML reader, the resolved-config
// writer, the help printer and the schema writer are visitors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace modcal {

/// Interval of allowed values, in the option's SI unit.
struct Range {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool lowest_allowed = true;
  bool highest_allowed = true;

  static constexpr Range any() { return {}; }
  static constexpr Range positive() {
    return {0.0, std::numeric_limits<double>::infinity(), false, true};
  }
  static constexpr Range non_negative() { return {0.0}; }
  static constexpr Range closed(double low, double high) { return {low, high, true, true}; }
  static constexpr Range open(double low, double high) { return {low, high, false, false}; }
  static constexpr Range at_least(double low) { return {low}; }

  /// False for NaN; infinities are never allowed.
  bool contains(double value) const;
  /// "> 0", "in [0, 1)", … for messages and help.
  std::string text() const;
};

/// What a visitor needs to know about one option besides its value.
struct OptionInfo {
  std::string_view key = {};
  std::string_view meaning = {};
  /// SI unit of a number ("m", "kg/m", "N", "s/m", "Hz", "1" for a pure number; a pure number may
  /// also be written in percent).
  std::string_view unit = "1";
  Range range = Range::any();
  /// A required option has no default: leaving it out is an error.
  bool required = false;
  /// Allowed words of a text option; empty: any text.
  std::vector<std::string_view> choices = {};
  /// A word that may stand for a number; the value is then NaN, of a whole number 0. Empty: no such
  /// word.
  std::string_view word = {};
};

class OptionVisitor;

/// The place of one plug-in in a configuration ("type: name" and that plug-in's options beside it).
class PluginSlot {
 public:
  virtual ~PluginSlot() = default;
  virtual std::string_view kind() const = 0;
  virtual std::vector<std::string_view> names() const = 0;
  virtual std::string_view summary(std::string_view name) const = 0;
  /// Name of the chosen plug-in; empty when none is chosen yet.
  virtual std::string_view selected() const = 0;
  /// Chooses a plug-in with its default options. Throws InvalidInput for an unknown name.
  virtual void select(std::string_view name) = 0;
  /// Visits the options of the chosen plug-in.
  virtual void visit_options(OptionVisitor& visitor) = 0;
};

/// A list of groups of one shape.
class ListSlot {
 public:
  virtual ~ListSlot() = default;
  virtual std::size_t size() const = 0;
  virtual void resize(std::size_t size) = 0;
  virtual void visit_item(std::size_t index, OptionVisitor& visitor) = 0;
};

// The cells of a sweep: copies of an experiment's options, each read with its own values.

/// One axis of a sweep: the dotted path of an option and the values it takes, as written.
struct SweepAxis {
  std::string path;
  std::vector<std::string> values;
};

/// Values of some options by their paths, as written.
using SweepPoint = std::vector<std::pair<std::string, std::string>>;

/// Which cells there are: every combination of the axes of `product` and of the groups of `zip`,
/// whose axes vary together, without the cells that agree with a point of `exclude`, then the
/// points of `include`. The last axis varies fastest.
struct SweepPlan {
  std::vector<SweepAxis> product;
  std::vector<std::vector<SweepAxis>> zip;
  std::vector<SweepPoint> exclude;
  std::vector<SweepPoint> include;
};

/// The values of every cell: `values[cell][i]` belongs to `paths[i]`; empty: the experiment's own.
struct SweepCells {
  std::vector<std::string> paths;
  std::vector<std::vector<std::string>> values;
};

/// The place of a sweep in a configuration.
class SweepSlot {
 public:
  virtual ~SweepSlot() = default;
  virtual const SweepPlan& plan() const = 0;
  /// Takes the plan and its cells and makes room for their options.
  virtual void set_cells(SweepPlan plan, SweepCells cells) = 0;
  virtual void visit_cell(std::size_t index, OptionVisitor& visitor) = 0;
};

/// ListSlot over a vector of a type with visit().
template <typename Item>
class ListOf final : public ListSlot {
 public:
  explicit ListOf(std::vector<Item>& items) : items_(items) {}
  std::size_t size() const override { return items_.size(); }
  void resize(std::size_t size) override { items_.resize(size); }
  void visit_item(std::size_t index, OptionVisitor& visitor) override {
    items_[index].visit(visitor);
  }

 private:
  std::vector<Item>& items_;
};

/// The value of an option, or the list of values.
using OptionValue = std::variant<double*, std::int64_t*, bool*, std::string*, std::vector<double>*,
                                 std::vector<std::int64_t>*, std::vector<std::string>*>;

class OptionVisitor {
 public:
  using VisitMembers = std::function<void(OptionVisitor&)>;
  virtual ~OptionVisitor() = default;
  virtual void value(const OptionInfo& info, OptionValue value) = 0;
  virtual void plugin(const OptionInfo& info, PluginSlot& slot) = 0;
  virtual void group(const OptionInfo& info, const VisitMembers& visit_members) = 0;
  /// A section that may be left out; `present` says whether it is there.
  virtual void optional_group(const OptionInfo& info, bool& present,
                              const VisitMembers& visit_members) = 0;
  virtual void list(const OptionInfo& info, ListSlot& slot) = 0;
  virtual void sweep(const OptionInfo& info, SweepSlot& slot) = 0;

  /// One option, by the type of `held`: a number, text, flag or list of them, a plug-in, a section
  /// (a type with visit()) or a list of sections. `info`: what there is to know beside key and
  /// meaning.
  template <typename Held>
  void operator()(std::string_view key, std::string_view meaning, OptionInfo info, Held& held) {
    info.key = key;
    info.meaning = meaning;
    if constexpr (requires { held.visit(*this); }) {
      group(info, [&held](OptionVisitor& inner) { held.visit(inner); });
    } else if constexpr (std::is_base_of_v<PluginSlot, Held>) {
      plugin(info, held);
    } else if constexpr (requires { held.front().visit(*this); }) {
      ListOf items(held);
      list(info, items);
    } else {
      value(info, &held);
    }
  }
  template <typename Held>
  void operator()(std::string_view key, std::string_view meaning, Held& held) {
    (*this)(key, meaning, {}, held);
  }
  /// A section that may be left out.
  template <typename Options>
  void operator()(std::string_view key, std::string_view meaning, bool& present, Options& options) {
    optional_group({.key = key, .meaning = meaning}, present,
                   [&options](OptionVisitor& inner) { options.visit(inner); });
  }
};

}  // namespace modcal
