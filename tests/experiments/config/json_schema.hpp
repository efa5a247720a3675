// The part of JSON Schema that the schema writer uses, so that tests can ask what a schema accepts.
#pragma once

#include <nlohmann/json.hpp>
#include <regex>
#include <stdexcept>
#include <string>

namespace modcal::testing {

class JsonSchema {
 public:
  explicit JsonSchema(nlohmann::json root) : root_(std::move(root)) {}
  bool accepts(const nlohmann::json& value) const { return accepts(root_, value); }

 private:
  using Json = nlohmann::json;

  static bool is_type(const Json& value, const std::string& type) {
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    if (type == "string") return value.is_string();
    if (type == "boolean") return value.is_boolean();
    if (type == "integer") return value.is_number_integer();
    if (type == "number") return value.is_number();
    throw std::logic_error("unknown type " + type);
  }

  std::size_t matches(const Json& schemas, const Json& value) const {
    std::size_t count = 0;
    for (const Json& schema : schemas) count += accepts(schema, value) ? 1 : 0;
    return count;
  }

  bool accepts_object(const Json& schema, const Json& value) const {
    for (const auto& [key, member] : value.items()) {
      if (schema["properties"].contains(key)) {
        if (!accepts(schema["properties"][key], member)) return false;
      } else if (schema.value("additionalProperties", true) == false) {
        return false;
      }
    }
    for (const Json& key : schema.value("required", Json::array())) {
      if (!value.contains(key.get<std::string>())) return false;
    }
    return true;
  }

  bool accepts_type(const Json& type, const Json& value) const {
    if (type.is_string()) return is_type(value, type);
    for (const Json& one : type) {
      if (is_type(value, one)) return true;
    }
    return false;
  }

  bool accepts(const Json& schema, const Json& value) const {
    for (const auto& [word, argument] : schema.items()) {
      bool right = true;
      if (word == "type") {
        right = accepts_type(argument, value);
      } else if (word == "$ref") {
        right = accepts(root_.at(Json::json_pointer(argument.get<std::string>().substr(1))), value);
      } else if (word == "const") {
        right = value == argument;
      } else if (word == "enum") {
        right = std::find(argument.begin(), argument.end(), value) != argument.end();
      } else if (word == "oneOf") {
        right = matches(argument, value) == 1;
      } else if (word == "allOf") {
        right = matches(argument, value) == argument.size();
      } else if (word == "if") {
        right = !accepts(argument, value) || accepts(schema["then"], value);
      } else if (word == "anyOf") {
        right = matches(argument, value) > 0;
      } else if (word == "minimum") {
        right = !value.is_number() || value >= argument;
      } else if (word == "exclusiveMinimum") {
        right = !value.is_number() || value > argument;
      } else if (word == "maximum") {
        right = !value.is_number() || value <= argument;
      } else if (word == "exclusiveMaximum") {
        right = !value.is_number() || value < argument;
      } else if (word == "minItems") {
        right = !value.is_array() || value.size() >= argument.get<std::size_t>();
      } else if (word == "maxItems") {
        right = !value.is_array() || value.size() <= argument.get<std::size_t>();
      } else if (word == "pattern") {
        right = !value.is_string() || std::regex_search(value.get<std::string>(),
                                                        std::regex(argument.get<std::string>()));
      } else if (word == "properties") {
        right = !value.is_object() || accepts_object(schema, value);
      } else if (word == "items") {
        for (const Json& item : value) right = right && accepts(argument, item);
      } else if (word != "required" && word != "then" && word != "additionalProperties" &&
                 word != "description" && word != "title" && word != "default" &&
                 word != "$schema" && word != "$defs") {
        throw std::logic_error("unknown keyword " + word);
      }
      if (!right) return false;
    }
    return true;
  }

  Json root_;
};

}  // namespace modcal::testing
