// Numbers, texts and flags, single ones and lists.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <limits>

#include "libsim/base/nearest_name.hpp"
#include "experiments/config/reader.hpp"
#include "experiments/config/reader_words.hpp"
#include "experiments/config/scalar.hpp"

namespace modcal {

bool YamlReader::read_number(const OptionInfo& info, const YamlNode& node, double& value) {
  if (node.kind != YamlNode::Kind::kScalar || node.quoted) {
    mistake(node, fmt::format("{} must be a number{}, not {}", info.key,
                              info.unit == "1" ? "" : fmt::format(" in {}", info.unit),
                              node.quoted ? "a quoted text" : kind_name(node)));
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

bool YamlReader::read_integer(const OptionInfo& info, const YamlNode& node, std::int64_t& value) {
  const std::string& text = node.text;
  std::int64_t parsed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), parsed);
  const bool whole = node.kind == YamlNode::Kind::kScalar && !node.quoted && error == std::errc() &&
                     end == text.data() + text.size();
  if (!whole) {
    mistake(node, fmt::format("{} must be a whole number, not {}", info.key,
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

bool YamlReader::read_text(const OptionInfo& info, const YamlNode& node, std::string& value) {
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

void YamlReader::number(const OptionInfo& info, double& value) {
  if (const YamlNode* node = take(info)) read_number(info, *node, value);
}

void YamlReader::integer(const OptionInfo& info, std::int64_t& value) {
  if (const YamlNode* node = take(info)) read_integer(info, *node, value);
}

void YamlReader::text(const OptionInfo& info, std::string& value) {
  if (const YamlNode* node = take(info)) read_text(info, *node, value);
}

template <typename Value, typename Read>
void YamlReader::read_list(const OptionInfo& info, std::vector<Value>& values, Read read) {
  const YamlNode* node = take(info);
  if (node == nullptr) return;
  values.clear();
  if (node->kind == YamlNode::Kind::kScalar && !(node->text.empty() && !node->quoted)) {
    Value value{};  // a single value is a list of one
    if (read(*node, value)) values.push_back(std::move(value));
    return;
  }
  if (node->kind != YamlNode::Kind::kSequence) {
    mistake(*node, fmt::format("{} must be a list, not {}", info.key, kind_name(*node)));
    return;
  }
  if (node->items.empty() && info.required) {
    mistake(*node, fmt::format("{} is an empty list", info.key));
  }
  for (const YamlNode& item : node->items) {
    Value value{};
    if (read(item, value)) values.push_back(std::move(value));
  }
}

void YamlReader::numbers(const OptionInfo& info, std::vector<double>& values) {
  read_list(info, values,
            [&](const YamlNode& node, double& value) { return read_number(info, node, value); });
}

void YamlReader::integers(const OptionInfo& info, std::vector<std::int64_t>& values) {
  read_list(info, values, [&](const YamlNode& node, std::int64_t& value) {
    return read_integer(info, node, value);
  });
}

void YamlReader::texts(const OptionInfo& info, std::vector<std::string>& values) {
  read_list(info, values,
            [&](const YamlNode& node, std::string& value) { return read_text(info, node, value); });
}

void YamlReader::flag(const OptionInfo& info, bool& value) {
  const YamlNode* node = take(info);
  if (node == nullptr) return;
  if (node->kind == YamlNode::Kind::kScalar && !node->quoted &&
      (node->text == "true" || node->text == "false")) {
    value = node->text == "true";
    return;
  }
  mistake(*node, fmt::format("{} must be true or false, not \"{}\"", info.key, node->text));
}

}  // namespace modcal
