// How every result describes itself: one visit() that names key, heading, unit, format and meaning
// of each value in one place. JSON (both ways) and tables with their CSV are visitors.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

#include "libsim/base/error.hpp"

namespace modcal {

/// What a visitor needs to know about one value of a result besides the value. The texts have to
/// live as long as the call.
struct ResultField {
  enum class Shown { kEverywhere, kInJson, kInTables };

  /// Name in JSON and CSV; empty: an item of a list, or a group whose members stand without it.
  std::string_view key = {};
  std::string_view table = {};  ///< id of the table that a list or a group makes; empty: none
  std::string_view name = {};   ///< heading where people read it; empty: the key
  std::string_view unit = {};   ///< SI unit; "1" or empty: a pure number
  std::string_view format = "{:.4g}";  ///< of a number where people read it (std::format syntax)
  std::string_view meaning = {};       ///< a sentence or two, the caption of the table
  Shown shown = Shown::kEverywhere;
  /// Left out of JSON where it is empty, and left as it is where JSON does not have it.
  bool optional = false;
  /// What the work took, which differs from run to run: no part of the numbers of a list.
  bool is_effort = false;
};

/// The number where it is finite; a table says nothing in the place of another, JSON null.
inline std::optional<double> known(double value) {
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// Writers look at the values, readers set them. visit() of a result that is only written is const
/// and may hand over values that it computes.
class ResultVisitor {
 public:
  using VisitMembers = std::function<void(ResultVisitor&)>;
  using VisitItem = std::function<void(ResultVisitor&, std::size_t)>;
  using Resize = std::function<void(std::size_t)>;
  static constexpr auto kInJson = ResultField::Shown::kInJson;
  static constexpr auto kInTables = ResultField::Shown::kInTables;

  virtual ~ResultVisitor() = default;
  using Value = std::variant<double*, std::int64_t*, bool*, std::string*>;
  virtual void value(const ResultField& field, Value held) = 0;
  /// Whether there is a value that may be missing: a writer repeats `known` and marks what is not,
  /// a reader looks.
  virtual bool is_known(const ResultField& field, bool known) = 0;
  virtual void group(const ResultField& field, const VisitMembers& visit_members) = 0;
  /// `resize` is empty where the length is fixed.
  virtual void list(const ResultField& field, std::size_t size, const Resize& resize,
                    const VisitItem& visit_item) = 0;

  /// Any value: number, text, flag, std::optional, vector, array, pair (a list of two), or a type
  /// with visit().
  template <typename Value>
  void operator()(const ResultField& field, Value&& value) {
    using Plain = std::remove_cvref_t<Value>;
    if constexpr (requires { value.visit(*this); }) {
      const auto members = [&value](ResultVisitor& visitor) { value.visit(visitor); };
      field.key.empty() ? members(*this) : group(field, members);
    } else if constexpr (std::is_same_v<Plain, bool>) {
      leaf<bool>(field, value);
    } else if constexpr (std::is_integral_v<Plain>) {
      leaf<std::int64_t>(field, value);
    } else if constexpr (std::is_floating_point_v<Plain>) {
      leaf<double>(field, value);
    } else if constexpr (std::is_convertible_v<Plain, std::string_view>) {
      leaf<std::string>(field, value);
    } else if constexpr (requires { value.has_value(); }) {
      optional(field, value);
    } else if constexpr (requires { value.first; }) {
      list(field, 2, {}, [&value](ResultVisitor& visitor, std::size_t i) {
        i == 0 ? visitor({}, value.first) : visitor({}, value.second);
      });
    } else {
      rows(field, value, [](ResultVisitor& visitor, auto& item) { visitor({}, item); });
    }
  }

  /// A list whose items are described by visit_row(visitor, item).
  template <typename Items, typename VisitRow>
  void rows(const ResultField& field, Items&& items, VisitRow visit_row) {
    Resize resize;
    if constexpr (requires { items.resize(std::size_t{}); }) {
      resize = [&items](std::size_t size) { items.resize(size); };
    }
    list(field, items.size(), resize,
         [&](ResultVisitor& visitor, std::size_t i) { visit_row(visitor, items[i]); });
  }

  /// One of the words name_of() has for the enumerators up to `last`; throws InvalidInput where
  /// another one is read.
  template <typename Enum>
  void word(const ResultField& field, Enum& value, Enum last) {
    std::string name(name_of(value));
    this->value(field, &name);
    for (int i = 0; i <= static_cast<int>(last); ++i) {
      value = static_cast<Enum>(i);
      if (name_of(value) == name) return;
    }
    throw_invalid_input("unknown {} \"{}\"", field.key, name);
  }

 private:
  template <typename Held, typename Given>
  void leaf(const ResultField& field, Given& given) {
    Held held(static_cast<Held>(given));
    value(field, &held);
    if constexpr (std::is_same_v<Given, std::string> || std::is_arithmetic_v<Given>) {
      if constexpr (!std::is_const_v<Given>) given = static_cast<Given>(held);
    }
  }
  template <typename Optional>
  void optional(const ResultField& field, Optional& value) {
    if (!is_known(field, value.has_value())) return;
    if constexpr (!std::is_const_v<Optional>) {
      if (!value) value.emplace();
    }
    (*this)(field, *value);
  }
};

}  // namespace modcal
