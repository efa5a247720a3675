// What the answers of several commands have in common, as a JSON schema.
#include "experiments/cli/answer_schema.hpp"

namespace modcal {
namespace {

constexpr const char* kParts = R"json({
  "number": {"type": ["number", "null"], "description": "null: not known"},
  "count": {"type": "integer", "minimum": 0},
  "words": {"type": "array", "items": {"type": "string"}},
  "place": {
    "description": "where an error is; null: nowhere",
    "type": ["object", "null"],
    "properties": {
      "file": {"type": "string"}, "line": {"$ref": "#/$defs/count"},
      "column": {"$ref": "#/$defs/count"}, "option": {"type": "string"}
    },
    "additionalProperties": false
  },
  "error": {
    "type": "object",
    "properties": {
      "kind": {"enum": ["usage", "invalid_input", "internal", "some_tasks_failed",
                        "acceptance_missed", "nothing_measured", "output_lost", "interrupted"]},
      "exit_code": {"type": "integer"}, "message": {"type": "string"},
      "place": {"$ref": "#/$defs/place"}, "further": {"$ref": "#/$defs/words"}
    },
    "required": ["kind", "exit_code", "message", "place"],
    "additionalProperties": false
  },
  "mistake": {
    "type": "object",
    "properties": {
      "severity": {"enum": ["error", "warning"]}, "place": {"type": "string"},
      "line": {"$ref": "#/$defs/count"}, "column": {"$ref": "#/$defs/count"},
      "text": {"type": "string"}
    },
    "required": ["severity", "place", "line", "column", "text"],
    "additionalProperties": false
  },
  "said": {
    "description": "what any answer may have",
    "type": "object",
    "properties": {
      "text": {"type": "string", "description": "what is said in words alone"},
      "warnings": {"$ref": "#/$defs/words"},
      "error": {"$ref": "#/$defs/error"},
      "mistakes": {"type": "array", "items": {"$ref": "#/$defs/mistake"}}
    }
  },
  "parameter": {
    "description": "a number that was found, with its standard deviation and where it started",
    "type": "object",
    "properties": {
      "name": {"type": "string"}, "value": {"$ref": "#/$defs/number"},
      "deviation": {"$ref": "#/$defs/number"}, "unit": {"type": "string"},
      "initial": {"$ref": "#/$defs/number"}
    },
    "required": ["name", "value", "deviation", "unit", "initial"],
    "additionalProperties": false
  },
  "score": {
    "description": "identified against true force: start and stop of the window [s], R, relative rms error, share within the 95 % band",
    "type": "object",
    "properties": {
      "side": {"type": "string"},
      "window": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
      "correlation": {"$ref": "#/$defs/number"},
      "relative_rms_error": {"$ref": "#/$defs/number"},
      "coverage": {"$ref": "#/$defs/number"}
    },
    "required": ["side", "window", "correlation", "relative_rms_error", "coverage"],
    "additionalProperties": false
  },
  "found": {
    "type": "object",
    "properties": {
      "verdict": {"type": "string", "description": "the answer in a sentence"},
      "parameters": {"type": "array", "items": {"$ref": "#/$defs/parameter"}},
      "scores": {"type": "array", "items": {"$ref": "#/$defs/score"}}
    },
    "required": ["verdict", "parameters", "scores"]
  },
  "results": {
    "description": "what a run leaves",
    "type": "object",
    "properties": {
      "out": {"type": "string", "description": "folder of the results"},
      "files": {"$ref": "#/$defs/words", "description": "in it, beside the report"},
      "report": {"type": "string"},
      "seconds": {"type": "number"},
      "verdict": {}, "parameters": {}, "scores": {},
      "failed_tasks": {"$ref": "#/$defs/count"},
      "failures": {
        "type": "array",
        "items": {
          "type": "object",
          "properties": {
            "reason": {"type": "string"}, "count": {"$ref": "#/$defs/count"},
            "first": {"type": "array", "items": {"$ref": "#/$defs/count"}}
          },
          "required": ["reason", "count", "first"],
          "additionalProperties": false
        }
      },
      "missed": {"$ref": "#/$defs/words", "description": "accepted figures"},
      "summary": {"type": "string"}
    }
  }
})json";

}  // namespace

const char* answer_parts() { return kParts; }

}  // namespace modcal
