// How every plug-in and every section of an experiment describes its options: one visit() that
// names key, unit, range, default and meaning in one place. The YAML reader, the resolved-config
// writer, the help printer and the schema writer are visitors.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libsim/base/sweep.hpp"

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
  std::string_view key;
  std::string_view meaning;
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

class OptionVisitor {
 public:
  using VisitMembers = std::function<void(OptionVisitor&)>;

  virtual ~OptionVisitor() = default;
  virtual void number(const OptionInfo& info, double& value) = 0;
  virtual void numbers(const OptionInfo& info, std::vector<double>& values) = 0;
  virtual void integer(const OptionInfo& info, std::int64_t& value) = 0;
  virtual void integers(const OptionInfo& info, std::vector<std::int64_t>& values) = 0;
  virtual void flag(const OptionInfo& info, bool& value) = 0;
  virtual void text(const OptionInfo& info, std::string& value) = 0;
  virtual void texts(const OptionInfo& info, std::vector<std::string>& values) = 0;
  virtual void plugin(const OptionInfo& info, PluginSlot& slot) = 0;
  virtual void group(const OptionInfo& info, const VisitMembers& visit_members) = 0;
  /// A section that may be left out; `present` says whether it is there.
  virtual void optional_group(const OptionInfo& info, bool& present,
                              const VisitMembers& visit_members) = 0;
  virtual void list(const OptionInfo& info, ListSlot& slot) = 0;
  virtual void sweep(const OptionInfo& info, SweepSlot& slot) = 0;

  /// A group whose type has a visit() of its own.
  template <typename Options>
  void section(const OptionInfo& info, Options& options) {
    group(info, [&options](OptionVisitor& visitor) { options.visit(visitor); });
  }
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

}  // namespace modcal
