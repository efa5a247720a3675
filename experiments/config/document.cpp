#include "experiments/config/document.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>
#include <tuple>

#include "libsim/base/error.hpp"
#include "libsim/base/files.hpp"
#include "libsim/base/utf8.hpp"

namespace modcal {
namespace {

std::vector<std::string> split_lines(const std::string& source) {
  std::vector<std::string> lines;
  std::istringstream stream(source);
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    lines.push_back(std::move(line));
  }
  return lines;
}

// The file first, then the arguments in their order ("--set 2" before "--set 10").
auto order_of(const SourcePosition& position) {
  return std::make_tuple(position.origin.size(), std::string_view(position.origin), position.line,
                         position.column);
}

std::string_view source_line(const YamlDocument& document, const SourcePosition& at) {
  for (const auto& [origin, text] : document.arguments) {
    if (origin == at.origin) return text;
  }
  const bool in_file = at.origin.empty() && at.line >= 1 && at.line <= document.lines.size();
  return in_file ? std::string_view(document.lines[at.line - 1]) : std::string_view();
}

// The bytes of a text from `start` on, `size` at most, without characters cut in two; "..." stands
// where some are left out.
std::string part_of(std::string_view text, std::size_t start, std::size_t size) {
  const auto at_character = [text](std::size_t at) {
    while (at > 0 && at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80)
      --at;
    return std::min(at, text.size());
  };
  const std::size_t first = at_character(start), last = at_character(start + size);
  return fmt::format("{}{}{}", first > 0 ? "..." : "", text.substr(first, last - first),
                     last < text.size() ? "..." : "");
}

// A line or a message that somebody else's program wrote may have a million characters.
constexpr std::size_t kShownLine = 200, kShownBefore = 80, kShownText = 2000;  // bytes

Complaint complaint_of(const YamlDocument& document, const Mistake& mistake) {
  const SourcePosition& at = mistake.position;
  const std::string_view line = source_line(document, at);
  const std::string_view before = line.substr(0, std::min(line.size(), at.column - 1));
  // Columns count characters, tabs stay tabs: the caret stands below its place.
  const std::size_t start =
      before.size() > kShownLine - kShownBefore ? before.size() - kShownBefore : 0;
  const std::string shown = part_of(line, start, kShownLine);
  std::string indent;
  for (const char byte : part_of(before, start, kShownLine)) {
    if (count_characters({&byte, 1}) == 1) indent += byte == '\t' ? '\t' : ' ';
  }
  Complaint complaint{
      .grade = mistake.warning ? Complaint::Grade::kWarning : Complaint::Grade::kError,
      .place = {.line = at.line, .column = count_characters(before) + 1, .option = at.origin},
      .text = part_of(mistake.text, 0, kShownText)};
  if (at.origin.empty()) complaint.place.file = document.file;
  if (!line.empty()) complaint.source = fmt::format("    {}\n    {}^\n", shown, indent);
  return complaint;
}

// Values put into a document from elsewhere: sweeps and the command line.

void refuse(YamlDocument& document, const SourcePosition& position, std::string text) {
  document.mistakes.push_back({position, std::move(text)});
}

/// "regularizer: water_level" is short for "regularizer: {type: water_level}".
void unfold_plugin(YamlNode& node, const SourcePosition& position) {
  if (node.kind != YamlNode::Kind::kScalar) return;
  YamlNode map;
  map.kind = YamlNode::Kind::kMap;
  map.position = position;
  if (!node.text.empty()) map.members.push_back({"type", position, std::move(node)});
  node = std::move(map);
}

YamlNode* step_into(YamlDocument& document, YamlNode& node, const std::string& key,
                    const SourcePosition& position) {
  if (node.kind == YamlNode::Kind::kSequence) {
    if (const YamlNode* item = node.child(key)) return const_cast<YamlNode*>(item);
    refuse(document, position,
           fmt::format("the list has no item \"{}\": it has {}, which count from 0", key,
                       node.items.size()));
    return nullptr;
  }
  unfold_plugin(node, position);
  if (YamlNode* known = node.find(key)) return known;
  node.members.push_back({key, position, {}});
  node.members.back().value.position = position;
  return &node.members.back().value;
}

void set_origin(YamlNode& node, const std::string& origin) {
  node.position.origin = origin;
  for (YamlNode& item : node.items) set_origin(item, origin);
  for (YamlNode::Member& member : node.members) {
    member.position.origin = origin;
    set_origin(member.value, origin);
  }
}

}  // namespace

const YamlNode* YamlNode::find(std::string_view key) const {
  for (const Member& member : members) {
    if (member.key == key) return &member.value;
  }
  return nullptr;
}

YamlNode* YamlNode::find(std::string_view key) {
  return const_cast<YamlNode*>(std::as_const(*this).find(key));
}

const YamlNode* YamlNode::child(std::string_view name) const {
  if (kind != Kind::kSequence) return find(name);
  std::size_t index = 0;
  const char* last = name.data() + name.size();
  const auto [end, error] = std::from_chars(name.data(), last, index);
  return error == std::errc() && end == last && index < items.size() ? &items[index] : nullptr;
}

std::filesystem::path YamlDocument::folder() const {
  return std::filesystem::path(file).parent_path();
}

YamlDocument parse_yaml(const std::string& source, std::string file) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  std::string text =
      source.starts_with(kByteOrderMark) ? source.substr(kByteOrderMark.size()) : source;
  // Lines of an old Macintosh.
  if (text.find('\n') == std::string::npos) std::ranges::replace(text, '\r', '\n');
  YamlDocument document;
  document.file = std::move(file);
  document.lines = split_lines(text);
  parse_yaml_text(document, text, 0);
  if (document.mistakes.empty() && document.root.kind != YamlNode::Kind::kMap) {
    document.mistakes.push_back(
        {document.root.position, "the file must be a map of keys and values, kind: first"});
  }
  return document;
}

YamlDocument read_yaml_file(const std::filesystem::path& path) {
  return parse_yaml(content_of_file(path), path.string());
}

std::vector<Complaint> complaints_of(const YamlDocument& document, std::vector<Mistake> mistakes) {
  std::stable_sort(mistakes.begin(), mistakes.end(), [](const Mistake& a, const Mistake& b) {
    return order_of(a.position) < order_of(b.position);
  });
  // Whoever has made so many mends the first ones first.
  constexpr std::size_t kMost = 50;
  const std::size_t shown = std::min(kMost, mistakes.size());
  std::vector<Complaint> complaints;
  for (std::size_t i = 0; i < shown; ++i) {
    complaints.push_back(complaint_of(document, mistakes[i]));
  }
  const auto is_error = [](const Mistake& mistake) { return !mistake.warning; };
  const auto hidden = mistakes.begin() + static_cast<std::ptrdiff_t>(shown);
  if (hidden != mistakes.end()) {
    const bool is_warning = std::none_of(hidden, mistakes.end(), is_error);
    complaints.push_back(
        {.grade = is_warning ? Complaint::Grade::kWarning : Complaint::Grade::kError,
         .text = fmt::format("{} more: mend these first", mistakes.size() - shown)});
  }
  return complaints;
}

std::string format_mistakes(const YamlDocument& document, const std::vector<Mistake>& mistakes) {
  std::string text;
  for (const Complaint& complaint : complaints_of(document, mistakes)) text += printed(complaint);
  return text;
}

void set_value(YamlDocument& document, std::string_view path, YamlNode value,
               const SourcePosition& path_position) {
  const bool has_empty_key = path.empty() || path.front() == '.' || path.back() == '.' ||
                             path.find("..") != std::string_view::npos;
  if (has_empty_key) {
    return refuse(
        document, path_position,
        fmt::format("\"{}\" is no path of an option: write its keys from the top with dots "
                    "between, as in scene.bow.position",
                    path));
  }
  YamlNode* node = &document.root;
  for (std::string_view rest = path; node != nullptr;) {
    const std::size_t dot = rest.find('.');
    node = step_into(document, *node, std::string(rest.substr(0, dot)), path_position);
    if (dot == std::string_view::npos) break;
    rest.remove_prefix(dot + 1);
  }
  if (node != nullptr) *node = std::move(value);
}

void apply_assignment(YamlDocument& document, std::string_view assignment, std::size_t number) {
  const SourcePosition start{1, 1, fmt::format("--set {}", number)};
  document.arguments.emplace_back(start.origin, assignment);
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    return refuse(document, start, fmt::format("\"{}\" is not key.path=value", assignment));
  }
  if (assignment.find_first_not_of(' ', equals + 1) == std::string_view::npos) {
    return refuse(
        document, start,
        fmt::format("\"{}\" has no value: write it behind the =, or leave --set out", assignment));
  }
  YamlDocument value;
  parse_yaml_text(value, std::string(assignment), equals + 1);
  for (Mistake& mistake : value.mistakes) {
    mistake.position.origin = start.origin;
    document.mistakes.push_back(std::move(mistake));
  }
  // A file that could not be parsed has no options to set; that is its mistake.
  if (!value.mistakes.empty() || document.root.kind != YamlNode::Kind::kMap) return;
  set_origin(value.root, start.origin);
  set_value(document, assignment.substr(0, equals), std::move(value.root), start);
}

}  // namespace modcal
