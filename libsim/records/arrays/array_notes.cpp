#include "libsim/records/arrays/array_notes.hpp"

#include <fmt/ranges.h>

#include <cmath>
#include <map>
#include <set>

#include "libsim/base/units.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/csv_grammar.hpp"

namespace modcal {
namespace {

constexpr std::string_view kFactor = "scale_factor", kOffset = "add_offset";

bool is_unit_name(const std::string& name) {
  return is_one_of(name, {"unit", "units", "unit_string", "ni_unitdescription", "channel_unit",
                          "channel_units"});
}

bool begin_alike(const NamedArray& a, const NamedArray& b, std::size_t depth) {
  return a.path.size() >= depth && b.path.size() >= depth &&
         std::equal(a.path.begin(), a.path.begin() + static_cast<long>(depth), b.path.begin());
}

// Right below the array, as an attribute is.
bool is_below(const NamedArray& note, const NamedArray& array) {
  return note.path.size() == array.path.size() + 1 && begin_alike(note, array, array.path.size());
}

// "dt_unit" beside dt; in other letters, DT_unit, where nothing is called DT.
bool is_named_after(const Content& content, const NamedArray& note, const NamedArray& array,
                    std::string_view word) {
  const std::string& name = array.path.back();
  const std::string& its = note.path.back();
  const bool is_its = its.size() == name.size() + 1 + word.size() && are_beside(note, array) &&
                      lower_case(its) == fmt::format("{}_{}", lower_case(name), word);
  if (!is_its || its.starts_with(name)) return is_its;
  const std::string called = its.substr(0, name.size());
  return std::ranges::none_of(content->arrays(), [&](const NamedArray& other) {
    return other.path.back() == called && are_beside(other, note);
  });
}

// Whether no other array of the structure may be what the note tells of.
bool is_alone(const Content& content, const NamedArray& array, const NamedArray& note) {
  const std::size_t depth = note.path.size() - 1;
  return std::ranges::none_of(content->arrays(), [&](const NamedArray& other) {
    return other.place != array.place && begin_alike(other, note, depth) &&
           may_be_channel(content, other);
  });
}

bool is_of_axis(const NamedArray& note) {
  return note.path.size() > 1 && note.path[note.path.size() - 2] == "x_values";
}

bool is_unit_note(const NamedArray& array) {
  return array.holds == NamedArray::Holds::kText && is_unit_name(last_of(array));
}

// The texts that are an array's own units; null: none.
const NamedArray* own_unit_note(const Content& content, const NamedArray& array) {
  for (const NamedArray& other : content->arrays()) {
    if (other.holds != NamedArray::Holds::kText) continue;
    const bool is_its = (is_below(other, array) && is_unit_name(last_of(other))) ||
                        is_named_after(content, other, array, "unit") ||
                        is_named_after(content, other, array, "units");
    if (is_its) return &other;
  }
  return nullptr;
}

// The unit of a signal: what else is called so may be a note of anything, or the unit of its axis.
bool may_be_of_channel(const Content& content, const NamedArray& note) {
  return std::ranges::all_of(content->texts(note), [](const std::string& text) {
    const std::string unit(trimmed(text));
    return is_unit(unit) && !is_unit_of(unit, "s");
  });
}

// The texts that are the units of an array; null: none.
const NamedArray* unit_note(const Content& content, const NamedArray& array) {
  if (const NamedArray* const own = own_unit_note(content, array)) return own;
  if (!may_be_channel(content, array)) return nullptr;
  const NamedArray* const note = nearest(content->arrays(), array, [](const NamedArray& other) {
    return is_unit_note(other) && !other.is_note && !is_of_axis(other);
  });
  const bool is_its =
      note != nullptr && is_alone(content, array, *note) && may_be_of_channel(content, *note);
  return is_its ? note : nullptr;
}

// One for all columns or one for each; else nothing.
template <typename Value>
std::optional<Value> of_column(const std::vector<Value>& values, const NamedArray& array,
                               std::size_t j) {
  if (values.size() == 1) return values[0];
  const bool is_each = array.is_table() && values.size() == array.columns();
  return is_each ? std::optional(values.at(j)) : std::nullopt;
}

std::vector<double> numbers_of(const Content& content, const NamedArray& note) {
  if (note.is_real() && note.size() == 1) return {content->number(note)};
  if (note.is_real() && note.is_table()) return content->column(note, 0);
  std::vector<double> numbers;
  if (note.holds != NamedArray::Holds::kText) return numbers;
  for (const std::string& text : content->texts(note)) {
    numbers.push_back(parse_number(trimmed(text)).value);
  }
  return numbers;
}

// The number `word` of a column.
void take_number(const Content& content, const NamedArray& array, std::size_t j,
                 std::string_view word, double& number, Packing& packing) {
  const std::vector<NamedArray>& arrays = content->arrays();
  const NamedArray* note = nearest(arrays, array, [word](const NamedArray& other) {
    return other.path.back().size() == word.size() && last_of(other) == word;
  });
  for (const NamedArray& other : arrays) {
    if (is_named_after(content, other, array, word)) note = &other;
  }
  if (note == nullptr) return;
  const bool is_its = is_below(*note, array) || is_named_after(content, *note, array, word);
  const bool is_of_data = last_of(array) == "data" && array.path.size() > 1;
  if (!is_its && !array.is_integer && !(is_of_data && are_beside(*note, array))) {
    packing.unapplied.push_back(note);
    return;
  }
  if (!is_its && !is_alone(content, array, *note)) {
    packing.fault = fmt::format(
        "channel beside others and one {}, which does not tell what it is of; "
        "call it {}_{}",
        note->text(), array.path.back(), word);
    return;
  }
  const std::vector<double> numbers = numbers_of(content, *note);
  const std::optional<double> own = of_column(numbers, array, j);
  if (!own) {
    packing.fault =
        fmt::format("channel of a table of {} with {} values of {}; one for each is needed",
                    array.is_table() ? array.columns() : 0, numbers.size(), note->text());
  } else if (!std::isfinite(*own) || (word == kFactor && *own == 0.0)) {
    const bool is_text = note->holds == NamedArray::Holds::kText;
    packing.fault = fmt::format("channel whose {} = {} cannot be applied; correct it", note->text(),
                                is_text ? content->text(*note) : fmt::format("{:g}", *own));
  } else {
    number = *own;
  }
}

}  // namespace

std::string last_of(const NamedArray& array) { return lower_case(array.path.back()); }

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool are_beside(const NamedArray& a, const NamedArray& b) {
  return a.path.size() == b.path.size() && begin_alike(a, b, a.path.size() - 1);
}

bool is_time(const Content& content, const NamedArray& array) {
  if (!is_name_of_time(array.path.back())) return false;
  std::string unit = array.unit;
  const NamedArray* const note = unit.empty() ? own_unit_note(content, array) : nullptr;
  if (note != nullptr) unit = trimmed(content->text(*note));
  return unit.empty() || is_unit_of(unit, "s");
}

bool may_be_channel(const Content& content, const NamedArray& array) {
  if (!array.has_numbers() || array.size() <= 1 || array.is_note) return false;
  const std::string name = last_of(array);
  return !name.ends_with(kFactor) && !name.ends_with(kOffset) && !is_time(content, array);
}

std::optional<std::size_t> scope(const NamedArray& array, const NamedArray& of) {
  std::size_t depth = of.path.size() - 1;
  if (depth > 0 && of.path[depth - 1] == "x_values") --depth;
  return begin_alike(array, of, depth) ? std::optional(depth) : std::nullopt;
}

std::string unit_of(const Content& content, const NamedArray& array, std::size_t j) {
  if (!array.unit.empty()) return array.unit;
  const NamedArray* const note = unit_note(content, array);
  if (note == nullptr) return {};
  return std::string(trimmed(of_column(content->texts(*note), array, j).value_or("")));
}

double unit_in(const Content& content, const NamedArray& array, std::string_view si) {
  std::string unit = unit_of(content, array);
  if (unit.empty()) unit = parse_column_heading(array.path.back()).unit;
  if (unit.empty()) return 1.0;
  return is_unit_of(unit, si) ? to_si(1.0, unit, si) : std::numeric_limits<double>::quiet_NaN();
}

std::vector<std::string> units_of_nobody(const Content& content) {
  std::set<std::size_t> taken;
  for (const NamedArray& array : content->arrays()) {
    if (!array.has_numbers()) continue;
    const NamedArray* const note = unit_note(content, array);
    if (note != nullptr && !unit_of(content, array).empty()) taken.insert(note->place);
  }
  std::vector<std::string> sentences;
  for (const NamedArray& note : content->arrays()) {
    if (!is_unit_note(note) || note.is_note || is_of_axis(note) || taken.contains(note.place)) {
      continue;
    }
    const std::string texts = fmt::format("{}", fmt::join(content->texts(note), ", "));
    if (trimmed(texts).empty()) continue;
    sentences.push_back(
        fmt::format("{} (\"{}\") is not read: it does not tell which array it is of; put a text "
                    "NAME_unit beside the array NAME",
                    note.text(), texts));
  }
  return sentences;
}

Packing packing_of(const Content& content, const NamedArray& array, std::size_t j) {
  Packing packing;
  take_number(content, array, j, kFactor, packing.factor, packing);
  take_number(content, array, j, kOffset, packing.offset, packing);
  if (!array.is_real() && packing.offset != 0.0) {
    packing.fault = "complex function with an add_offset, which is applied to real ones alone";
  }
  return packing;
}

std::vector<std::string> unapplied_packing(const Content& content) {
  std::map<const NamedArray*, std::vector<const NamedArray*>> beside;
  const auto is_packing = [](const NamedArray& array) {
    return is_one_of(last_of(array), {kFactor, kOffset});
  };
  if (std::ranges::none_of(content->arrays(), is_packing)) return {};
  for (const NamedArray& array : content->arrays()) {
    if (!may_be_channel(content, array)) continue;
    for (const NamedArray* const note : packing_of(content, array, 0).unapplied) {
      beside[note].push_back(&array);
    }
  }
  std::vector<std::string> sentences;
  for (const auto& [note, arrays] : beside) {
    const NamedArray& first = *arrays.front();
    sentences.push_back(fmt::format(
        "{} stands beside {}{}: it is not applied to numbers that are not integers; where it is "
        "meant, call it {}_{}",
        note->text(), first.text(), arrays.size() > 1 ? " and others" : "", first.path.back(),
        last_of(*note)));
  }
  return sentences;
}

}  // namespace modcal
