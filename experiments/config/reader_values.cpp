// Numbers, texts and flags, single ones and lists.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "experiments/config/reader.hpp"
#include "libsim/base/units.hpp"
#include "libsim/base/words.hpp"

namespace modcal {
namespace {

// A leading 0 before another digit: YAML 1.1 reads 010 as 8.
bool looks_octal(std::string_view text) {
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  return text.size() > 1 && text[0] == '0' && text[1] >= '0' && text[1] <= '9';
}

/// The digits of a number moved by `shift` decimal places: one rounding, as if it had been written
/// in the SI unit.
double shifted(std::string_view number, int shift) {
  const std::size_t mark = number.find_first_of("eE");
  int exponent = 0;
  if (mark != std::string_view::npos) {
    std::string_view digits = number.substr(mark + 1);
    if (digits.starts_with('+')) digits.remove_prefix(1);
    std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
  }
  exponent = std::clamp(exponent, -100000, 100000);  // far out of range already
  const std::string text = fmt::format("{}e{}", number.substr(0, mark), exponent + shift);
  double value = std::numeric_limits<double>::quiet_NaN();
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  return read.ec == std::errc() ? value : std::numeric_limits<double>::quiet_NaN();
}

// What a list of numbers is for, where people write a word or a flag in its place.
struct ListHint {
  std::string_view key, hint;
};
constexpr ListHint kListHints[] = {
    {"whole", "; write the long window as [start, stop], such as whole: [0.1 s, 0.4 s]"},
    {"windows",
     "; windows lists the starts of short windows: a long one is whole: [start, stop], and without "
     "windows all of the record but its ends is scored"},
};

std::string unit_mistake(std::string_view text, std::string_view unit, std::string_view si_unit,
                         const std::string& expected) {
  if (is_unit(unit)) {
    return fmt::format("\"{}\" has the unit {}, which cannot be converted to {}: {} is needed",
                       text, unit, si_unit == "1" ? "a pure number" : si_unit, expected);
  }
  const std::string nearest = nearest_unit(unit, si_unit);
  return fmt::format("\"{}\": {} is not a unit{}; {} is needed", text, unit,
                     nearest.empty() ? "" : fmt::format(", did you mean \"{}\"?", nearest),
                     expected);
}

}  // namespace

bool YamlReader::read(const OptionInfo& info, const YamlNode& node, double& value) {
  if (node.kind != YamlNode::Kind::kScalar || node.quoted) {
    mistake(node,
            fmt::format("{} must be a number{}, not {}", info.key,
                        info.unit == "1" ? "" : fmt::format(" in {}", info.unit),
                        node.quoted ? "a quoted text: leave out the quotes" : kind_name(node)));
    return false;
  }
  if (!info.word.empty() && node.text == info.word) {
    value = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  const ScalarNumber number = parse_number(node.text, info.unit);
  if (!number.error.empty()) {
    mistake(node, fmt::format("{}: {}{}", info.key, number.error,
                              info.word.empty() ? "" : fmt::format(" (or {})", info.word)));
    return false;
  }
  if (!info.range.contains(number.value)) {
    mistake(node, fmt::format(
                      "{} is {}{}: it must be {}", info.key, node.text,
                      info.unit == "1" || node.text.find(' ') != std::string::npos
                          ? ""
                          : fmt::format(" {}", info.unit),
                      info.range.text() + (info.unit == "1" ? "" : fmt::format(" {}", info.unit))));
    return false;
  }
  value = number.value;
  return true;
}

bool YamlReader::read(const OptionInfo& info, const YamlNode& node, std::int64_t& value) {
  const std::string& text = node.text;
  const bool scalar = node.kind == YamlNode::Kind::kScalar && !node.quoted;
  if (!info.word.empty() && scalar && text == info.word) {
    value = 0;
    return true;
  }
  std::int64_t parsed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), parsed);
  const bool read_all = scalar && end == text.data() + text.size();
  if (read_all && error == std::errc::result_out_of_range) {
    constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
    mistake(node, fmt::format("{} is {}: the number is too {}; it must be {}", info.key, text,
                              text.starts_with('-') ? "small" : "large",
                              std::isfinite(info.range.highest)
                                  ? info.range.text()
                                  : fmt::format("{}, {} at most", info.range.text(), kMost)));
    return false;
  }
  const bool whole = read_all && error == std::errc();
  if (!whole) {
    mistake(node, fmt::format("{} must be a whole number{}, not {}", info.key,
                              info.word.empty() ? "" : fmt::format(" or {}", info.word),
                              node.kind == YamlNode::Kind::kScalar ? fmt::format("\"{}\"", text)
                                                                   : std::string(kind_name(node))));
    return false;
  }
  if (looks_octal(text)) {
    mistake(node,
            fmt::format("{}: \"{}\" looks octal: write it without the leading 0", info.key, text));
    return false;
  }
  if (!info.range.contains(static_cast<double>(parsed))) {
    mistake(node, fmt::format("{} is {}: it must be {}", info.key, text, info.range.text()));
    return false;
  }
  value = parsed;
  return true;
}

bool YamlReader::read(const OptionInfo& info, const YamlNode& node, std::string& value) {
  if (node.kind != YamlNode::Kind::kScalar || (node.text.empty() && !node.quoted)) {
    mistake(node, fmt::format("{} must be a text, not {}", info.key, kind_name(node)));
    return false;
  }
  const auto& choices = info.choices;
  if (!choices.empty() && std::find(choices.begin(), choices.end(), node.text) == choices.end()) {
    mistake(node, fmt::format("{}: \"{}\" is not one of {}{}", info.key, node.text,
                              fmt::join(choices, ", "),
                              nearest_name(node.text, strings_of(choices)).empty()
                                  ? ""
                                  : suggestion(node.text, strings_of(choices))));
    return false;
  }
  value = node.text;
  return true;
}

bool YamlReader::read(const OptionInfo& info, const YamlNode& node, bool& value) {
  const bool yes = node.text == "true";
  if (node.kind == YamlNode::Kind::kScalar && !node.quoted && (yes || node.text == "false")) {
    value = yes;
    return true;
  }
  mistake(node, fmt::format("{} must be true or false, not \"{}\"", info.key, node.text));
  return false;
}

template <typename Value>
bool YamlReader::read(const OptionInfo& info, const YamlNode& node, std::vector<Value>& values) {
  values.clear();
  const auto add = [&](const YamlNode& item) {
    Value value{};
    if (read(info, item, value)) {
      if constexpr (std::is_same_v<Value, std::string>) {
        if (!info.choices.empty() && std::ranges::count(values, value) > 0) {
          mistake(item,
                  fmt::format("{}: {} stands here twice: leave one of them", info.key, value));
        }
      }
      return values.push_back(std::move(value));
    }
    const auto known = std::ranges::find(kListHints, info.key, &ListHint::key);
    const bool is_word = item.text.find_first_of("0123456789") == std::string::npos;
    if (known != std::end(kListHints) && is_word && !item.refused) {
      mistakes_.back().text += known->hint;
    }
  };
  if (node.kind == YamlNode::Kind::kScalar && !(node.text.empty() && !node.quoted)) {
    add(node);  // a single value is a list of one
  } else if (node.kind != YamlNode::Kind::kSequence) {
    mistake(node, fmt::format("{} must be a list, not {}", info.key, kind_name(node)));
  } else if (node.items.empty() && info.required) {
    mistake(node, fmt::format("{} is an empty list", info.key));
  }
  for (const YamlNode& item : node.items) add(item);
  return true;
}

void YamlReader::value(const OptionInfo& info, OptionValue value) {
  const YamlNode* node = take(info);
  if (node == nullptr) return;
  std::visit([&](auto* held) { read(info, *node, *held); }, value);
}

namespace {

// Of texts that were copied from a page.
struct Lookalike {
  std::string_view written, name, meant;
};
constexpr Lookalike kLookalikes[] = {{"\u2212", "a minus of print", "the hyphen -"},
                                     {"\u2013", "a dash", "the hyphen -"},
                                     {"\u00a0", "a blank that does not break", "a plain one"},
                                     {"\u202f", "a narrow blank", "a plain one"}};

}  // namespace

ScalarNumber parse_number(std::string_view text, std::string_view si_unit) {
  const auto failed = [](std::string reason) { return ScalarNumber{0.0, std::move(reason)}; };
  const std::string expected =
      si_unit == "1" ? "a number"
                     : fmt::format("a number in {}, such as {},", si_unit, unit_example(si_unit));
  if (text.empty()) return failed("there is no value: " + expected + " is needed");
  if (text[0] == '.' && text.size() > 1 && std::isalpha(static_cast<unsigned char>(text[1]))) {
    return failed(fmt::format("\"{}\" is not finite: {} is needed", text, expected));
  }
  for (const Lookalike& other : kLookalikes) {
    if (text.find(other.written) == std::string_view::npos) continue;
    return failed(fmt::format("\"{}\": {} stands here: write {}", text, other.name, other.meant));
  }
  if (looks_octal(text)) {
    return failed(fmt::format("\"{}\" looks octal: write it without the leading 0", text));
  }
  // from_chars does not take a plus.
  const bool plus = text[0] == '+' && text.size() > 1 && text[1] != '-';
  const char* begin = text.data() + (plus ? 1 : 0);
  const char* last = text.data() + text.size();
  double value = 0.0;
  const auto [end, error] = std::from_chars(begin, last, value);
  if (error == std::errc::result_out_of_range) {
    return failed(fmt::format("\"{}\" is beyond the range of numbers", text));
  }
  if (error != std::errc() || !std::isfinite(value)) {
    return failed(fmt::format("\"{}\" is not a number: {} is needed", text, expected));
  }
  std::string_view unit(end, static_cast<std::size_t>(last - end));
  while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
  if (unit.empty()) return {value, {}};
  if (unit.front() == ',') {
    return failed(fmt::format("\"{}\": write a decimal point, not a comma", text));
  }
  const auto scale = unit_scale(unit, si_unit);
  if (!scale) return failed(unit_mistake(text, unit, si_unit, expected));
  const double si =
      scale->decimal_exponent
          ? shifted({begin, static_cast<std::size_t>(end - begin)}, *scale->decimal_exponent)
          : scale->factor * value + scale->offset;
  if (!std::isfinite(si)) return failed(fmt::format("\"{}\" is beyond the range of numbers", text));
  return {si, {}};
}

}  // namespace modcal
