#include "experiments/config/complaint.hpp"

#include <fmt/format.h>

#include <charconv>

namespace modcal {
namespace {

std::string_view word_of(Complaint::Grade grade) {
  switch (grade) {
    case Complaint::Grade::kError:
      return "error";
    case Complaint::Grade::kWarning:
      return "warning";
    case Complaint::Grade::kInternalError:
      break;
  }
  return "internal error";
}

/// "a.yaml:3:7"
std::string text_of(const InputPlace& place) {
  if (!place.option.empty()) return place.option;
  std::string text = place.file;
  if (place.line > 0) text += fmt::format(":{}", place.line);
  if (place.column > 0) text += fmt::format(":{}", place.column);
  return text;
}

}  // namespace

InputPlace place_named(std::string_view name) {
  if (name.starts_with("--")) return {.option = std::string(name)};
  const std::size_t colon = name.rfind(':');
  if (colon == std::string_view::npos) return {.file = std::string(name)};
  std::size_t line = 0;
  const char* last = name.data() + name.size();
  const auto [end, error] = std::from_chars(name.data() + colon + 1, last, line);
  if (error != std::errc() || end != last) return {.file = std::string(name)};
  return {.file = std::string(name.substr(0, colon)), .line = line};
}

Complaint complaint_of(const InvalidInput& error) {
  const std::string text = error.what();
  if (error.place().empty()) return {.text = text};
  return {.place = place_named(error.place()), .text = text.substr(error.place().size() + 2)};
}

std::string message_of(const Complaint& complaint) {
  if (complaint.place.empty()) return complaint.text;
  return fmt::format("{}: {}", text_of(complaint.place), complaint.text);
}

std::string printed(const Complaint& complaint) {
  const std::string_view word = word_of(complaint.grade);
  // Editors know a place with a column where it begins the line.
  if (complaint.place.column == 0) {
    return fmt::format("{}: {}\n{}", word, message_of(complaint), complaint.source);
  }
  return fmt::format("{}{}: {}: {}\n{}", complaint.place.option.empty() ? "" : "command line, ",
                     text_of(complaint.place), word, complaint.text, complaint.source);
}

}  // namespace modcal
