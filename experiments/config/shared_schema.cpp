// A JSON schema in which nothing stands twice.
#include <fmt/format.h>

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "experiments/config/help.hpp"

namespace modcal {
namespace {

using Json = nlohmann::ordered_json;
/// A schema within another one, and a word for what it describes.
using VisitPart = std::function<void(Json& part, const std::string& name)>;

void for_each_part(Json& schema, const std::string& name, const VisitPart& visit) {
  for (const char* word : {"anyOf", "oneOf", "allOf"}) {
    if (!schema.contains(word)) continue;
    for (Json& part : schema[word]) visit(part, name);
  }
  for (const char* word : {"items", "then"}) {
    if (schema.contains(word)) visit(schema[word], name);
  }
  if (!schema.contains("properties")) return;
  for (auto& [key, part] : schema["properties"].items()) visit(part, key);
}

// What is equal for parts that differ in what they are called alone.
Json without_description(Json schema) {
  schema.erase("description");
  return schema;
}

class Sharing {
 public:
  explicit Sharing(Json schema) : schema_(std::move(schema)) {}

  Json shared() {
    count(schema_, "");
    for_each_part(schema_, "", [this](Json& part, const std::string& name) { share(part, name); });
    schema_["$defs"] = std::move(definitions_);
    return std::move(schema_);
  }

 private:
  // Shorter parts are easier read where they stand.
  static constexpr std::size_t kShortest = 200;

  void count(Json& schema, const std::string& name) {
    for_each_part(schema, name, [this](Json& part, const std::string& inner) {
      if (part.is_object()) ++uses_[without_description(part).dump()];
      count(part, inner);
    });
  }

  void share(Json& part, const std::string& name) {
    if (!part.is_object()) return;
    const auto share_within = [this, &name](Json& schema) {
      for_each_part(schema, name,
                    [this](Json& inner, const std::string& key) { share(inner, key); });
    };
    Json body = without_description(part);
    const std::string text = body.dump();
    if (text.size() < kShortest || uses_[text] < 2) return share_within(part);
    const auto [place, is_new] = names_.try_emplace(text);
    if (is_new) {
      place->second = unused_name(name);
      const std::string own = place->second;
      share_within(body);
      definitions_[own] = std::move(body);
    }
    Json reference = {{"$ref", "#/$defs/" + names_.at(text)}};
    if (part.contains("description")) reference["description"] = part["description"];
    part = std::move(reference);
  }

  std::string unused_name(const std::string& name) {
    std::string unused = name;
    for (std::size_t i = 2; !taken_.insert(unused).second; ++i)
      unused = fmt::format("{}_{}", name, i);
    return unused;
  }

  Json schema_;
  Json definitions_ = Json::object();
  std::map<std::string, std::size_t> uses_;   ///< by the part's text
  std::map<std::string, std::string> names_;  ///< of the definitions, likewise
  std::set<std::string> taken_;
};

}  // namespace

Json with_shared_parts(Json schema) { return Sharing(std::move(schema)).shared(); }

}  // namespace modcal
