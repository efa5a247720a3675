// What a command says: texts and messages, or one JSON object.
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>

#include "experiments/cli/command.hpp"
#include "libsim/base/utf8.hpp"

namespace modcal {
namespace {

// Why standard output has not taken a text; 0: it has taken all.
int output_error = 0;

void write_out(std::string_view text) {
  if (Caller* caller = Caller::here()) {
    caller->said += text;
    return;
  }
  const Progress::Pause pause;
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) < text.size() && output_error == 0) {
    output_error = errno;
  }
}

// What --json answers when the command has ended.
struct JsonAnswer {
  nlohmann::ordered_json data;  ///< null: nothing was said as data
  std::string text;             ///< said on standard output as text
  nlohmann::ordered_json warnings = nlohmann::ordered_json::array();
  std::vector<Complaint> errors;
};
// Of the thread that was asked: several may answer at a time.
JsonAnswer& json_answer() {
  static thread_local JsonAnswer answer;
  return answer;
}

std::string_view kind_of(ExitCode code) {
  switch (code) {
    case ExitCode::kOk:
      return "none";
    case ExitCode::kUsage:
      return "usage";
    case ExitCode::kInvalidInput:
      return "invalid_input";
    case ExitCode::kSomeTasksFailed:
      return "some_tasks_failed";
    case ExitCode::kAcceptanceMissed:
      return "acceptance_missed";
    case ExitCode::kNothingMeasured:
      return "nothing_measured";
    case ExitCode::kOutputLost:
      return "output_lost";
    case ExitCode::kInterrupted:
      return "interrupted";
    case ExitCode::kInternal:
      break;
  }
  return "internal";
}

// {"option"} or {"file", "line", "column"}, as far as they are known; null: nothing is.
nlohmann::ordered_json json_of(const InputPlace& place) {
  if (place.empty()) return nullptr;
  if (!place.option.empty()) return {{"option", place.option}};
  nlohmann::ordered_json result = {{"file", place.file}};
  if (place.line > 0) result["line"] = place.line;
  if (place.column > 0) result["column"] = place.column;
  return result;
}

// reason: of the run, which is the message where nothing else was complained of.
nlohmann::ordered_json error_json(ExitCode code, const std::vector<Complaint>& errors,
                                  const std::string& reason) {
  nlohmann::ordered_json error = {{"kind", kind_of(code)}, {"exit_code", static_cast<int>(code)}};
  error["message"] = !errors.empty()   ? message_of(errors.front())
                     : !reason.empty() ? reason
                                       : std::string(meaning_of(code));
  error["place"] = errors.empty() ? nlohmann::ordered_json() : json_of(errors.front().place);
  for (std::size_t i = 1; i < errors.size(); ++i) error["further"].push_back(message_of(errors[i]));
  return error;
}

// What failed of a list, or else its verdict.
std::string reason_in(const nlohmann::ordered_json& answer) {
  const auto failures = answer.find("failures");
  if (failures == answer.end() || failures->empty()) return answer.value("verdict", std::string());
  const auto& first = failures->front();
  return fmt::format("{} tasks failed, task {} as: {}", answer.value("failed_tasks", 0),
                     first["first"].front().get<std::size_t>(), first["reason"].get<std::string>());
}

void write_json_answer(ExitCode code) {
  JsonAnswer& answer = json_answer();
  if (answer.data.is_array() && code == ExitCode::kOk) return write_out(json_text(answer.data));
  nlohmann::ordered_json object =
      answer.data.is_object() ? std::move(answer.data) : nlohmann::ordered_json::object();
  if (!answer.text.empty()) object["text"] = answer.text;
  if (!answer.warnings.empty()) object["warnings"] = answer.warnings;
  if (code != ExitCode::kOk) {
    object["error"] = error_json(code, answer.errors, reason_in(object));
  }
  write_out(json_text(object));
}

// Marks a word that begins a line or follows the place of a mistake, "a.yaml:3:7: error: …".
void mark(std::string& text, std::string_view word, std::string_view code) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at)) {
    const std::string_view before(text.data(), at);
    const bool begins = before.empty() || before.ends_with('\n') || before.ends_with(": ");
    const std::string marked = begins ? fmt::format("{}{}\033[0m", code, word) : std::string(word);
    text.replace(at, word.size(), marked);
    at += marked.size();
  }
}

}  // namespace

namespace {
thread_local Caller* caller_here = nullptr;
}

Caller::Caller(const std::atomic<bool>& stop_flag, std::function<void(double)> told)
    : stop(stop_flag), progress(std::move(told)) {
  caller_here = this;
}

Caller::~Caller() { caller_here = nullptr; }

Caller* Caller::here() { return caller_here; }

AnswerStyle& answer_style() {
  static AnswerStyle style;
  return style;
}

std::string_view meaning_of(ExitCode code) {
  switch (code) {
    case ExitCode::kOk:
      return "ok";
    case ExitCode::kUsage:
      return "wrong usage";
    case ExitCode::kInvalidInput:
      return "invalid input";
    case ExitCode::kSomeTasksFailed:
      return "some tasks failed";
    case ExitCode::kAcceptanceMissed:
      return "an accepted figure was missed";
    case ExitCode::kNothingMeasured:
      return "nothing could be measured";
    case ExitCode::kOutputLost:
      return "what was computed is lost";
    case ExitCode::kInterrupted:
      return "interrupted";
    case ExitCode::kInternal:
      break;
  }
  return "internal error";
}

ExitCode finish_answer(ExitCode code) {
  if (answer_style().json) write_json_answer(code);
  if (Caller::here() != nullptr) return code;
  errno = 0;
  const bool taken = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (!taken && output_error == 0) output_error = errno != 0 ? errno : EIO;
  // A reader that closes its pipe, such as head, has what it wanted.
  if (output_error == 0 || output_error == EPIPE) return code;
  complain({.text = fmt::format("standard output has not taken the answer: {}",
                                std::strerror(output_error))});
  return code == ExitCode::kOk ? ExitCode::kOutputLost : code;
}

void say_text(std::string_view text) {
  if (answer_style().json) {
    json_answer().text += text;
  } else {
    write_out(printable(text));
  }
}

void complain(const Complaint& complaint) {
  if (complaint.grade == Complaint::Grade::kWarning) {
    json_answer().warnings.push_back(message_of(complaint));
  } else {
    json_answer().errors.push_back(complaint);
  }
  hint_text(printed(complaint));
}

void complain(const std::vector<Complaint>& complaints) {
  for (const Complaint& complaint : complaints) complain(complaint);
}

void hint_text(std::string_view text) {
  if (Caller::here() != nullptr) return;
  const Progress::Pause pause;
  std::fputs(colored(printable(text)).c_str(), stderr);
}

void remark_text(std::string_view text) {
  if (answer_style().quiet || Caller::here() != nullptr) return;
  const Progress::Pause pause;
  std::fputs(printable(text).c_str(), stderr);
}

std::string json_text(const nlohmann::ordered_json& object) {
  return object.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

void print_json(const nlohmann::ordered_json& object) {
  if (answer_style().json) {
    json_answer().data = object;
  } else {
    say_text(json_text(object));
  }
}

void add_to_json(const std::string& key, const nlohmann::ordered_json& value) {
  if (answer_style().json && !json_answer().data.is_array()) json_answer().data[key] = value;
}

void note_warning(const std::string& text) { json_answer().warnings.push_back(text); }

bool can_rewrite() {
  const char* terminal = std::getenv("TERM");
  return isatty(STDERR_FILENO) != 0 && terminal != nullptr && std::string_view(terminal) != "dumb";
}

std::string colored(const std::string& text) {
  const char* refused = std::getenv("NO_COLOR");
  if (!can_rewrite() || (refused != nullptr && *refused != '\0')) return text;
  std::string marked = text;
  mark(marked, "error:", "\033[1;31m");
  mark(marked, "warning:", "\033[1;33m");
  // The caret below a mistake's line stands alone on its own.
  for (std::size_t at = marked.find("^\n"); at != std::string::npos; at = marked.find("^\n", at)) {
    const std::size_t start = marked.rfind('\n', at) + 1;  // npos + 1 is 0
    const bool alone = start > 0 && marked.find_first_not_of(' ', start) == at;
    if (alone) marked.replace(at, 1, "\033[1m^\033[0m");
    at += alone ? 9 : 1;
  }
  return marked;
}

}  // namespace modcal
