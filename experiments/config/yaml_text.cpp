#include "experiments/config/yaml_text.hpp"

#include <fmt/format.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <sstream>

#include "experiments/config/tree_builder.hpp"

namespace modcal {
namespace {

bool is_continuation(char byte) { return (static_cast<unsigned char>(byte) & 0xC0) == 0x80; }

// Bytes of the UTF-8 character that begins the text; 0 where none does.
std::size_t character_size(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  std::size_t size = 0;
  if (first > 0 && first < 0x80) size = 1;
  if (first >= 0xC2 && first <= 0xDF) size = 2;
  if (first >= 0xE0 && first <= 0xEF) size = 3;
  if (first >= 0xF0 && first <= 0xF4) size = 4;
  if (size == 0 || size > text.size()) return 0;
  const std::string_view rest = text.substr(1, size - 1);
  return std::all_of(rest.begin(), rest.end(), is_continuation) ? size : 0;
}

bool is_utf8(YamlDocument& document, std::string_view text) {
  SourcePosition position{1, 1, {}};
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t size = character_size(text.substr(i));
    if (size == 0) {
      document.mistakes.push_back(
          {position, fmt::format("byte 0x{:02x} is not UTF-8 text: save the file as UTF-8",
                                 static_cast<unsigned char>(text[i]))});
      return false;
    }
    position.column += size;
    if (text[i] == '\n') position = {position.line + 1, 1, {}};
    i += size;
  }
  return true;
}

bool has_tabs(YamlDocument& document, const std::string& text) {
  std::istringstream stream(text);
  std::size_t number = 0;
  bool found = false;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const std::size_t first = line.find_first_not_of(" \t\r");
    const std::size_t tab = line.find('\t');
    if (first == std::string::npos || line[first] == '#' || tab > first) continue;
    document.mistakes.push_back({{number, tab + 1, {}}, "a tab in the indentation: use blanks"});
    found = true;
  }
  return found;
}

SourcePosition end_of(const std::string& text) {
  const std::size_t last = text.find_last_not_of("\r\n");
  if (last == std::string::npos) return {1, 1, {}};
  const std::size_t start = text.rfind('\n', last) + 1;  // npos + 1 is 0
  const auto lines = std::count(text.begin(), text.begin() + static_cast<long>(start), '\n');
  return {static_cast<std::size_t>(lines) + 1, last - start + 2, {}};
}

/// yaml-cpp's messages in words that say what to do.
std::string explain(const std::string& message) {
  if (message == YAML::ErrorMsg::MAP_VALUE) {
    return "a \":\" cannot stand here: begin the keys of one map in one column, and put a text "
           "with "
           "\": \" in it into quotes";
  }
  if (message == YAML::ErrorMsg::END_OF_MAP || message == YAML::ErrorMsg::END_OF_SEQ) {
    return "the indentation fits neither the entry above nor the one around it: begin the line in "
           "the column of the entries it belongs to";
  }
  if (message == YAML::ErrorMsg::FLOW_END) {
    return "a closing bracket without an opening one: delete it";
  }
  if (message == YAML::ErrorMsg::UNKNOWN_ANCHOR) {
    return "aliases (*name) are not supported: write the value out";
  }
  if (message == YAML::ErrorMsg::UNKNOWN_TOKEN) {
    return "this character cannot begin a value: put the text into quotes";
  }
  return "not YAML: " + message;
}

Mistake syntax_mistake(const YAML::ParserException& error, const TreeBuilder& builder,
                       const std::string& text) {
  const YamlNode* inner = builder.innermost();
  if (inner != nullptr && error.msg == YAML::ErrorMsg::END_OF_SEQ_FLOW) {
    return {inner->position, "this \"[\" is not closed: add \"]\" behind its last item"};
  }
  if (inner != nullptr && error.msg == YAML::ErrorMsg::END_OF_MAP_FLOW) {
    return {inner->position, "this \"{\" is not closed: add \"}\" behind its last entry"};
  }
  // yaml-cpp gives no place for what is missing at the end.
  return {error.mark.is_null() ? end_of(text) : position_of(error.mark), explain(error.msg)};
}

}  // namespace

std::size_t count_characters(std::string_view text) {
  return text.size() -
         static_cast<std::size_t>(std::count_if(text.begin(), text.end(), is_continuation));
}

void parse_yaml_text(YamlDocument& document, const std::string& text, std::size_t skip) {
  if (!is_utf8(document, text) || has_tabs(document, text)) return;
  std::istringstream stream(std::string(skip, ' ') + text.substr(skip));
  TreeBuilder builder(document, text);
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::ParserException& error) {
    document.mistakes.push_back(syntax_mistake(error, builder, text));
    return;
  }
  if (!builder.has_root()) {
    document.mistakes.push_back({{1, 1, {}}, "the file is empty: an experiment starts with kind:"});
    return;
  }
  document.root = builder.take_root();
}

}  // namespace modcal
