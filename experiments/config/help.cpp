#include "experiments/config/help.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace modcal {
namespace {

using Json = nlohmann::ordered_json;

// Type of the values of a list, or of a value that stands alone.
template <typename Value>
struct ItemOf {
  using Type = Value;
};
template <typename Item>
struct ItemOf<std::vector<Item>> {
  using Type = Item;
};

struct SweepPart {
  std::string_view key, type, meaning;
};
constexpr SweepPart kSweepParts[] = {
    {"product", "map of axes, such as {scene.bow.normal_force: [0.5 N, 1 N], seed: [1, 2, 3]}",
     "every value of one axis with every value of the others"},
    {"zip",
     "list of maps of axes, such as [{scene.bow.velocity: [0.1, 0.2], scene.bow.position: [30 mm, "
     "40 mm]}]",
     "axes of one map move together: first values, second values, ..."},
    {"exclude", "list of cells, such as [{scene.bow.normal_force: 1 N, seed: 3}]",
     "combinations to leave out, with values as they stand on the axes"},
    {"include", "list of cells, such as [{scene.bow.position: 45 mm}]",
     "single cells to add, of any keys above"},
};

class Describer final : public OptionVisitor {
 public:
  Json entries = Json::array();

  void value(const OptionInfo& info, OptionValue value) override {
    std::visit([&](const auto* held) { describe(info, *held); }, value);
  }
  void plugin(const OptionInfo& info, PluginSlot& slot) override {
    Json& entry = add(info, "plug-in");
    entry["kind"] = slot.kind();
    entry["choices"] = slot.names();
    if (!slot.selected().empty()) entry["default"] = slot.selected();
  }
  void group(const OptionInfo& info, const VisitMembers& visit_members) override {
    Describer inner;
    visit_members(inner);
    add(info, "section")["options"] = inner.entries;
  }
  void optional_group(const OptionInfo& info, bool& present,
                      const VisitMembers& visit_members) override {
    Describer inner;
    visit_members(inner);
    Json& entry = add(info, "optional section");
    entry["options"] = inner.entries;
    if (present) entry["present"] = true;
  }
  void list(const OptionInfo& info, ListSlot& slot) override {
    Describer inner;
    slot.resize(1);
    slot.visit_item(0, inner);
    slot.resize(0);
    add(info, "list of sections")["options"] = inner.entries;
  }
  void sweep(const OptionInfo& info, SweepSlot& /*slot*/) override {
    Json parts = Json::array();
    for (const auto& [key, type, meaning] : kSweepParts) {
      parts.push_back({{"key", key}, {"type", type}, {"meaning", meaning}});
    }
    add(info, "section")["options"] = std::move(parts);
  }

 private:
  template <typename Value>
  void describe(const OptionInfo& info, const Value& value) {
    using Item = typename ItemOf<Value>::Type;
    constexpr bool kIsReal = std::is_same_v<Item, double>;
    constexpr bool kIsWhole = std::is_same_v<Item, std::int64_t>;
    const std::string type = std::is_same_v<Item, bool> ? "true or false"
                             : kIsReal                  ? "number"
                             : kIsWhole                 ? "whole number"
                                                        : "text";
    Json& entry = add(info, std::is_same_v<Item, Value> ? type : fmt::format("list of {}s", type));
    if (kIsReal) entry["unit"] = info.unit;
    if (kIsReal || kIsWhole) entry["range"] = info.range.text();
    if (!info.choices.empty()) entry["choices"] = info.choices;
    if (info.required) return;
    entry["default"] = value;
    if constexpr (std::is_same_v<Value, double>) {
      if (!std::isfinite(value)) entry["default"] = nullptr;
      if (std::isnan(value) && !info.word.empty()) entry["default"] = info.word;
    }
    if constexpr (std::is_same_v<Value, std::int64_t>) {
      if (value == 0 && !info.word.empty()) entry["default"] = info.word;
    }
  }

  Json& add(const OptionInfo& info, std::string_view type) {
    Json entry = {{"key", info.key}, {"type", type}, {"meaning", info.meaning}};
    if (info.required) entry["required"] = true;
    if (!info.word.empty()) entry["word"] = info.word;
    entries.push_back(std::move(entry));
    return entries.back();
  }
};

class SchemaWriter final : public OptionVisitor {
 public:
  Json properties = Json::object();
  Json required = Json::array();

  Json schema() const {
    Json result = {{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
    if (!required.empty()) result["required"] = required;
    return result;
  }
  void value(const OptionInfo& info, OptionValue value) override {
    std::visit(
        [&]<typename Value>(const Value*) {
          using Item = typename ItemOf<Value>::Type;
          Json item = {{"type", "boolean"}};
          if (std::is_same_v<Item, double>) item = number_schema(info);
          if (std::is_same_v<Item, std::int64_t>) item = integer_schema(info);
          if (std::is_same_v<Item, std::string>) item = text_schema(info);
          if (!std::is_same_v<Item, Value>) {
            Json list = {{"type", "array"}, {"items", item}};
            item = any_of(std::move(item), std::move(list));
          }
          add(info, std::move(item));
        },
        value);
  }
  void plugin(const OptionInfo& info, PluginSlot& slot) override {
    Json variants = Json::array();
    variants.push_back({{"enum", slot.names()}});
    const std::string selected(slot.selected());
    for (const std::string_view name : slot.names()) {
      slot.select(name);
      SchemaWriter inner;
      slot.visit_options(inner);
      inner.properties["type"] = {{"const", name}};
      inner.required.push_back("type");
      Json variant = inner.schema();
      variant["description"] = slot.summary(name);
      variants.push_back(std::move(variant));
    }
    if (!selected.empty()) slot.select(selected);
    add(info, {{"anyOf", std::move(variants)}});
  }
  void group(const OptionInfo& info, const VisitMembers& visit_members) override {
    SchemaWriter inner;
    visit_members(inner);
    add(info, inner.schema());
    // Without the section its required options would be missing.
    if (!inner.required.empty() && !info.required) required.push_back(info.key);
  }
  void optional_group(const OptionInfo& info, bool&, const VisitMembers& visit_members) override {
    SchemaWriter inner;
    visit_members(inner);
    add(info, inner.schema());
  }
  void list(const OptionInfo& info, ListSlot& slot) override {
    SchemaWriter inner;
    slot.resize(1);
    slot.visit_item(0, inner);
    slot.resize(0);
    add(info, {{"type", "array"}, {"items", inner.schema()}});
  }
  void sweep(const OptionInfo& info, SweepSlot&) override {
    const Json values = {{"type", "array"}, {"minItems", 1}};
    const Json axes = {{"type", "object"}, {"additionalProperties", values}, {"minProperties", 1}};
    const Json points = {{"type", "array"}, {"items", {{"type", "object"}}}, {"minItems", 1}};
    add(info, {{"type", "object"},
               {"properties",
                {{"product", axes},
                 {"zip", {{"type", "array"}, {"items", axes}, {"minItems", 1}}},
                 {"exclude", points},
                 {"include", points}}},
               {"minProperties", 1},
               {"additionalProperties", false}});
  }

 private:
  // In braces within braces clang 14 would lose what a call returns.
  static Json any_of(Json first, Json second) {
    Json schema = Json::object();
    Json& either = schema["anyOf"];
    either.push_back(std::move(first));
    either.push_back(std::move(second));
    return schema;
  }
  static Json bounded(Json schema, const Range& range) {
    if (std::isfinite(range.lowest)) {
      schema[range.lowest_allowed ? "minimum" : "exclusiveMinimum"] = range.lowest;
    }
    if (std::isfinite(range.highest)) {
      schema[range.highest_allowed ? "maximum" : "exclusiveMaximum"] = range.highest;
    }
    return schema;
  }
  static Json integer_schema(const OptionInfo& info) {
    Json schema = bounded({{"type", "integer"}}, info.range);
    if (info.word.empty()) return schema;
    return any_of(std::move(schema), {{"const", info.word}});
  }
  static Json number_schema(const OptionInfo& info) {
    Json schema =
        any_of(bounded({{"type", "number"}}, info.range),
               {{"type", "string"}, {"pattern", "^[-+]?[0-9.]+([eE][-+]?[0-9]+)? *\\S*"}});
    if (!info.word.empty()) schema["anyOf"].push_back({{"const", info.word}});
    return schema;
  }
  static Json text_schema(const OptionInfo& info) {
    if (info.choices.empty()) return {{"type", {"string", "number"}}};
    return {{"enum", info.choices}};
  }
  void add(const OptionInfo& info, Json schema) {
    schema["description"] = info.unit == "1" ? std::string(info.meaning)
                                             : fmt::format("{} [{}]", info.meaning, info.unit);
    properties[std::string(info.key)] = std::move(schema);
    if (info.required) required.push_back(info.key);
  }
};

std::string plain(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

void append_text(const Json& options, std::size_t level, std::string& text) {
  for (const Json& option : options) {
    std::string line =
        fmt::format("{}{}", std::string(2 * level, ' '), option["key"].get<std::string>());
    const std::string type = option["type"].get<std::string>();
    std::string details = type;
    if (option.contains("unit") && option["unit"] != "1")
      details += " [" + plain(option["unit"]) + "]";
    if (option.contains("range") && option["range"] != "any finite number") {
      details += " " + plain(option["range"]);
    }
    if (option.contains("choices")) {
      details +=
          fmt::format(": {}", fmt::join(option["choices"].get<std::vector<std::string>>(), ", "));
    }
    if (option.contains("word")) details += " or " + plain(option["word"]);
    if (option.contains("required")) details += "; required";
    if (option.contains("default") && !option["default"].is_null()) {
      details += "; default " + plain(option["default"]);
    }
    text += fmt::format("{:<26} {}\n{:<26} {}\n", line, plain(option["meaning"]), "", details);
    if (option.contains("options")) append_text(option["options"], level + 1, text);
  }
}

}  // namespace

nlohmann::ordered_json describe_options(const std::function<void(OptionVisitor&)>& visit) {
  Describer describer;
  visit(describer);
  return describer.entries;
}

std::string help_text(const nlohmann::ordered_json& options) {
  std::string text;
  append_text(options, 0, text);
  return text;
}

nlohmann::ordered_json options_schema(const std::function<void(OptionVisitor&)>& visit) {
  SchemaWriter writer;
  visit(writer);
  return writer.schema();
}

}  // namespace modcal
