// A report as plain data: what an experiment hands over to be written.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "experiments/report/audio.hpp"
#include "experiments/report/figure.hpp"
#include "experiments/report/table.hpp"

namespace modcal::report {

/// Plain text; an empty line starts a new paragraph, kPreformatted keeps all lines.
struct Text {
  enum class Kind { kParagraph, kNote, kWarning, kFailure, kPreformatted };
  std::string text = {};
  Kind kind = Kind::kParagraph;
};

/// What a section is made of. A new type of block is added here; the compiler then names every
/// writer that has to learn it.
using Block = std::variant<Text, Figure, Table, Audio>;

struct Section {
  std::string title = {};
  std::vector<Block> blocks = {};
};

/// kFailed: nothing succeeded (the page is headed in red); kSomeFailed: part of it did.
enum class Status { kOk, kSomeFailed, kFailed };

/// A line on where the numbers come from: {"commit", "1a2b3c…"}.
struct ProvenanceLine {
  std::string name = {};
  std::string value = {};
};

struct Report {
  std::string title = {};
  std::string description = {};
  Status status = Status::kOk;
  std::string status_text = {};  ///< "40 of 40 tasks done"; empty: the status alone
  std::vector<Section> sections = {};
  std::vector<ProvenanceLine> provenance = {};
  std::string command = {};  ///< what makes the whole report again
  /// Command that replays a task, without the task's number at its end; empty: none.
  std::string replay = {};
};

}  // namespace modcal::report
