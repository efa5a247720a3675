// What --json answers, as a JSON schema.
#include "experiments/cli/answer_schema.hpp"

#include <nlohmann/json.hpp>

namespace modcal {
namespace {

struct Command {
  const char* name;
  const char* properties;          ///< of its answer
  std::vector<const char*> known;  ///< those that an answer without an error has
  std::vector<const char*> parts = {};
  std::vector<const char*> or_else = {};  ///< those that another one has: of a part of a list
};

const std::vector<const char*> kLeft = {"out",          "files",  "report", "seconds",
                                        "failed_tasks", "missed", "summary"};

constexpr const char* kLimit = R"json({
  "noise_level": {"$ref": "#/$defs/number"},
  "parameters": {"type": "array", "items": {
    "type": "object",
    "properties": {
      "name": {"type": "string"}, "sd": {"$ref": "#/$defs/number"},
      "attainable_sd": {"$ref": "#/$defs/number"},
      "sd_with_free_frequencies": {"$ref": "#/$defs/number"},
      "correlations": {"type": "array", "items": {"$ref": "#/$defs/number"}}},
    "required": ["name", "sd"], "additionalProperties": false}},
  "modes": {"type": "array", "items": {
    "type": "object",
    "properties": {
      "frequency": {"type": "number"}, "relative_sd": {"$ref": "#/$defs/number"},
      "verdict": {"type": "string"}, "reason": {"type": "string"}},
    "required": ["frequency", "relative_sd", "verdict"], "additionalProperties": false}},
  "blind_modes": {"$ref": "#/$defs/count"}
})json";

constexpr const char* kPlan = R"json({
  "kind": {"type": "string"}, "title": {"type": "string"},
  "work": {
    "type": "object",
    "properties": {
      "simulations": {"type": "array", "items": {
        "type": "object",
        "properties": {
          "count": {"$ref": "#/$defs/count"}, "duration": {"type": "number"},
          "samples": {"$ref": "#/$defs/count"}, "sample_rate": {"type": "number"}},
        "required": ["count", "duration", "samples", "sample_rate"],
        "additionalProperties": false}},
      "tasks": {"$ref": "#/$defs/count"},
      "axes": {"type": "array", "items": {
        "type": "object",
        "properties": {"paths": {"$ref": "#/$defs/words"}, "values": {"$ref": "#/$defs/count"}},
        "required": ["paths", "values"], "additionalProperties": false}},
      "record": {"type": "string"},
      "methods": {"$ref": "#/$defs/words"}, "conditions": {"$ref": "#/$defs/words"},
      "calibration": {
        "type": "object",
        "properties": {
          "parameters": {"$ref": "#/$defs/count"}, "modes": {"$ref": "#/$defs/count"},
          "modes_of_record": {"type": "boolean"}, "objective": {"type": "string"},
          "optimizer": {"type": "string"}, "evaluations": {"$ref": "#/$defs/count"}},
        "additionalProperties": false}
    }
  },
  "simulation": {
    "description": "one of them, in samples, steps and seconds",
    "type": "object",
    "properties": {
      "modes": {"$ref": "#/$defs/count"}, "modes_moved": {"$ref": "#/$defs/count"},
      "samples": {"$ref": "#/$defs/count"}, "longest_step": {"type": "number"},
      "steps": {"type": "number"}, "set_up_seconds": {"type": "number"},
      "seconds": {"type": "number"}, "measured_on_first": {"type": "number"},
      "skips": {"type": "array", "items": {
        "type": "object",
        "properties": {
          "what": {"type": "string"}, "reason": {"type": "string"}, "note": {"type": "string"},
          "saved_seconds": {"$ref": "#/$defs/number"}, "saved_percent": {"$ref": "#/$defs/number"}},
        "additionalProperties": false}}},
    "additionalProperties": false
  },
  "memory_bytes": {"type": "number"},
  "price": {
    "type": "object",
    "properties": {
      "core_seconds": {"type": "number"}, "core_hours": {"type": "number"},
      "threads": {"$ref": "#/$defs/count"}, "seconds": {"type": "number"},
      "basis": {"type": "string"}, "disk_bytes": {"type": "number"}},
    "required": ["core_seconds", "threads", "seconds"], "additionalProperties": false
  }
})json";

constexpr const char* kInspect = R"json({
  "file": {"type": "string"}, "format": {"type": "string"},
  "sample_rate": {"$ref": "#/$defs/number"}, "rate_source": {"type": "string"},
  "time_jitter": {"$ref": "#/$defs/number"}, "samples": {"$ref": "#/$defs/count"},
  "measured": {"type": "boolean"}, "duration": {"$ref": "#/$defs/number"},
  "channels": {"type": "array", "items": {"type": "object", "required": ["name", "unit"]}},
  "noise_assumption": {"type": "string"},
  "noise_band_of_nyquist": {"type": "array", "items": {"type": "number"}},
  "problems": {"$ref": "#/$defs/words"}, "problem_count": {"$ref": "#/$defs/count"},
  "stanza": {"type": "string"}
})json";

constexpr const char* kStatus = R"json({
  "kind": {"type": "string"}, "title": {"type": "string"}, "running": {"type": "boolean"},
  "tasks": {"$ref": "#/$defs/count"}, "done": {"$ref": "#/$defs/count"},
  "failed": {"$ref": "#/$defs/count"}, "pending": {"$ref": "#/$defs/count"},
  "other_results": {"$ref": "#/$defs/count"},
  "damaged_lines": {"$ref": "#/$defs/count"}, "median_task_seconds": {"type": "number"},
  "left_core_seconds": {"type": "number"}, "command": {"type": "string"}
})json";

constexpr const char* kCompare = R"json({
  "tasks_in_common": {"$ref": "#/$defs/count"}, "number": {"type": "string"},
  "medians": {"type": "array", "items": {"$ref": "#/$defs/number"}},
  "ratio": {"$ref": "#/$defs/number"},
  "interval": {"type": "array", "items": {"$ref": "#/$defs/number"}},
  "verdict": {"type": "string"}
})json";

constexpr const char* kShard =
    R"json({"done": {"$ref": "#/$defs/count"}, "tasks": {"$ref": "#/$defs/count"}})json";

constexpr const char* kExperiments = R"json({
  "experiments": {"type": "array", "items": {
    "type": "object",
    "allOf": [{"$ref": "#/$defs/found"}],
    "properties": {"name": {"type": "string"}, "out": {"type": "string"}},
    "required": ["name", "out"], "unevaluatedProperties": false}}
})json";

const Command kCommands[] = {
    {"run", kShard, kLeft, {"results"}, {"done", "tasks"}},
    {"reproduce", kExperiments, {"out", "report"}, {"results"}},
    {"report", "{}", kLeft, {"results"}},
    {"replay", R"({"axes": {"type": "object"}})", kLeft, {"results"}},
    {"validate",
     R"({"file": {"type": "string"}, "valid": {"type": "boolean"}, "kind": {"type": "string"}})",
     {"file", "valid", "kind", "mistakes"}},
    {"plan", kPlan, {"kind", "title", "work"}},
    {"limit", kLimit, {"noise_level", "parameters", "modes", "blind_modes"}},
    {"describe",
     R"({"kind": {"type": "string"}, "name": {"type": "string"}, "summary": {"type": "string"},
         "options": {"type": "array", "items": {"type": "object", "required": ["key", "type"]}}})",
     {"kind", "name", "summary", "options"}},
    {"inspect", kInspect, {"file", "format", "channels", "problems", "warnings", "stanza"}},
    {"convert",
     R"({"file": {"type": "string"}, "channels": {"$ref": "#/$defs/count"}})",
     {"file", "channels"}},
    {"new", R"({"file": {"type": "string"}})", {"text"}},
    {"status", kStatus, {"kind", "tasks", "done", "failed", "pending", "running"}},
    {"merge",
     R"({"database": {"type": "string"}, "tasks": {"$ref": "#/$defs/count"},
         "done": {"$ref": "#/$defs/count"}, "digest": {"type": "string"}})",
     {"database", "tasks", "done", "digest"}},
    {"compare", kCompare, {"tasks_in_common", "ratio", "interval", "verdict"}},
    {"submit",
     R"({"tasks": {"$ref": "#/$defs/count"}, "jobs": {"$ref": "#/$defs/count"},
         "scripts": {"type": "string"}, "array": {}, "merge": {}})",
     {"tasks", "jobs", "scripts"}},
    {"help", "{}", {"text"}},
    {"completion", "{}", {"text"}},
    {"man", "{}", {"text"}},
};

using Json = nlohmann::ordered_json;

Json reference(const std::string& part) { return {{"$ref", "#/$defs/" + part}}; }

// What an answer without an error has stands beside that an answer has one.
Json schema_of(const Command& command) {
  Json parts = Json::array({reference("said")});
  for (const char* part : command.parts) parts.push_back(reference(part));
  Json schema = {{"type", "object"},
                 {"allOf", std::move(parts)},
                 {"properties", Json::parse(command.properties)}};
  Json of_error = {{"required", Json::array({"error"})}};
  Json of_answer = {{"required", command.known}};
  schema["anyOf"] = Json::array({std::move(of_error), std::move(of_answer)});
  if (!command.or_else.empty()) schema["anyOf"].push_back({{"required", command.or_else}});
  schema["unevaluatedProperties"] = false;
  return schema;
}

}  // namespace

Json answer_schema() {
  Json parts = Json::parse(answer_parts());
  const Json found = parts["found"]["properties"];
  for (const auto& [name, type] : found.items()) parts["results"]["properties"][name] = type;
  Json any = Json::array();
  for (const Command& command : kCommands) {
    parts[command.name] = schema_of(command);
    any.push_back(reference(command.name));
  }
  parts["list"] = {
      {"type", "array"},
      {"items",
       {{"type", "object"},
        {"properties", {{"name", {{"type", "string"}}}, {"summary", {{"type", "string"}}}}},
        {"required", Json::array({"name", "summary"})},
        {"additionalProperties", false}}}};
  parts["schema"] = {{"type", "object"}, {"required", Json::array({"$schema"})}};
  for (const char* name : {"list", "schema"}) any.push_back(reference(name));
  return {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
          {"title", "answers of modcal"},
          {"description", "what modcal COMMAND --json answers is a #/$defs/COMMAND"},
          {"anyOf", std::move(any)},
          {"$defs", std::move(parts)}};
}

}  // namespace modcal
