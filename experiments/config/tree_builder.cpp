#include "experiments/config/tree_builder.hpp"

#include <fmt/format.h>

#include <utility>

namespace modcal {
namespace {

// Byte behind the closing quote of the text that begins at `start`; npos where it is not closed.
std::size_t end_of_quoted(std::string_view text, std::size_t start) {
  const char quote = text[start];
  for (std::size_t i = start + 1; i < text.size(); ++i) {
    if (quote == '"' && text[i] == '\\') {
      ++i;
    } else if (text[i] == quote) {
      if (quote == '"' || i + 1 >= text.size() || text[i + 1] != quote) return i + 1;
      ++i;
    }
  }
  return std::string_view::npos;
}

// yaml-cpp's own offset counts differently behind a byte order mark.
std::size_t offset_of(std::string_view text, const YAML::Mark& mark) {
  std::size_t start = 0;
  for (int line = 0; line < mark.line && start != std::string_view::npos; ++line) {
    start = text.find('\n', start);
    if (start != std::string_view::npos) ++start;
  }
  return start == std::string_view::npos ? start : start + static_cast<std::size_t>(mark.column);
}

}  // namespace

SourcePosition position_of(const YAML::Mark& mark) {
  if (mark.is_null()) return {};
  return {static_cast<std::size_t>(mark.line) + 1, static_cast<std::size_t>(mark.column) + 1, {}};
}

void TreeBuilder::refuse(const YAML::Mark& mark, std::string text) {
  document_.mistakes.push_back({position_of(mark), std::move(text)});
}

void TreeBuilder::OnDocumentStart(const YAML::Mark& mark) {
  if (++documents_ == 2)
    refuse(mark, "a second YAML document (---) begins here: keep one in a file");
}

void TreeBuilder::OnNull(const YAML::Mark& mark, YAML::anchor_t) {
  YamlNode node;
  node.position = position_of(mark);
  add(std::move(node));
}

void TreeBuilder::OnAlias(const YAML::Mark& mark, YAML::anchor_t) {
  const bool merged = !levels_.empty() && levels_.back().has_key && levels_.back().key == "<<";
  if (!merged) refuse(mark, "aliases (*name) are not supported: write the value out");
  YamlNode node;
  node.position = position_of(mark);
  node.refused = true;
  add(std::move(node));
}

void TreeBuilder::OnAnchor(const YAML::Mark& mark, const std::string& name) {
  refuse(mark, fmt::format("anchors (&{}) are not supported: write the value out", name));
}

void TreeBuilder::OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                           const std::string& value) {
  YamlNode node;
  node.position = position_of(mark);
  node.text = value;
  node.quoted = tag == "!";
  if (node.quoted) refuse_open_quote(mark);
  refuse_tag(mark, tag);
  add(std::move(node));
}

// yaml-cpp takes the end of the file for a closing quote.
void TreeBuilder::refuse_open_quote(const YAML::Mark& mark) {
  const std::size_t start = offset_of(text_, mark);
  if (start >= text_.size() || (text_[start] != '"' && text_[start] != '\'')) return;
  if (end_of_quoted(text_, start) != std::string_view::npos) return;
  refuse(mark, fmt::format("the quote {0} is not closed: end the text with {0}", text_[start]));
}

void TreeBuilder::refuse_tag(const YAML::Mark& mark, const std::string& tag) {
  if (tag.empty() || tag == "!" || tag == "?") return;
  refuse(mark, fmt::format("the tag {} is not supported: leave it out", tag));
}

void TreeBuilder::OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                                  YAML::EmitterStyle::value) {
  open(mark, tag, YamlNode::Kind::kSequence);
}

void TreeBuilder::OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                             YAML::EmitterStyle::value) {
  open(mark, tag, YamlNode::Kind::kMap);
}

void TreeBuilder::open(const YAML::Mark& mark, const std::string& tag, YamlNode::Kind kind) {
  refuse_tag(mark, tag);
  Level level;
  level.node.kind = kind;
  level.node.position = position_of(mark);
  levels_.push_back(std::move(level));
}

void TreeBuilder::close() {
  YamlNode node = std::move(levels_.back().node);
  levels_.pop_back();
  add(std::move(node));
}

void TreeBuilder::add(YamlNode node) {
  if (levels_.empty()) {
    if (documents_ > 1) return;
    root_ = std::move(node);
    has_root_ = true;
    return;
  }
  Level& level = levels_.back();
  if (level.node.kind == YamlNode::Kind::kSequence) {
    level.node.items.push_back(std::move(node));
  } else if (!level.has_key) {
    take_key(level, node);
  } else {
    add_member(level, std::move(node));
  }
}

void TreeBuilder::take_key(Level& level, const YamlNode& node) {
  level.has_key = true;
  level.key = node.text;
  level.key_position = node.position;
  if (node.kind != YamlNode::Kind::kScalar || (node.text.empty() && !node.refused)) {
    document_.mistakes.push_back({node.position, "a key must be a plain word"});
  } else if (node.text == "<<" && !node.quoted) {
    document_.mistakes.push_back(
        {node.position, "merge keys (<<) are not supported: write the values out"});
  }
}

void TreeBuilder::add_member(Level& level, YamlNode node) {
  level.has_key = false;
  for (const YamlNode::Member& member : level.node.members) {
    if (member.key != level.key) continue;
    document_.mistakes.push_back(
        {level.key_position, fmt::format("duplicate key \"{}\": it stands in line {} already",
                                         level.key, member.position.line)});
    return;
  }
  level.node.members.push_back({level.key, level.key_position, std::move(node)});
}

}  // namespace modcal
