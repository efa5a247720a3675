#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <sstream>
#include <unordered_map>

#include "experiments/config/document.hpp"
#include "experiments/config/source_text.hpp"

namespace modcal {
namespace {

SourcePosition position_of(const YAML::Mark& mark) {
  if (mark.is_null()) return {};
  return {static_cast<std::size_t>(mark.line) + 1, static_cast<std::size_t>(mark.column) + 1, {}};
}

YamlNode node_at(const YAML::Mark& mark, YamlNode::Kind kind = YamlNode::Kind::kScalar) {
  YamlNode node;
  node.kind = kind;
  node.position = position_of(mark);
  return node;
}

// Builds a document's tree from the events of yaml-cpp's parser. Unlike YAML::Node, events show
// duplicate keys, anchors and the place of every key. What is refused becomes a mistake of
// `document`.
class TreeBuilder final : public YAML::EventHandler {
 public:
  /// `text`: what is parsed, for what yaml-cpp does not see.
  TreeBuilder(YamlDocument& document, std::string_view text)
      : document_(document), text_(text), line_starts_(line_starts(text)) {}

  bool has_root() const { return has_root_; }
  /// yaml-cpp begins document after document at what it cannot read, and takes nothing of it.
  bool has_second_document() const { return documents_ > 1; }
  YamlNode take_root() { return std::move(root_); }
  /// The list or map that is open where parsing stopped; null at the top.
  const YamlNode* innermost() const { return levels_.empty() ? nullptr : &levels_.back().node; }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ != 2) return;
    const bool comma = text_.substr(std::min(offset_of(mark), text_.size())).starts_with(',');
    refuse(mark, comma ? "a \",\" cannot stand here: begin comments with #, and put a text with it "
                         "into quotes"
                       : "a second YAML document (---) begins here: keep one in a file");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { add(node_at(mark)); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    const bool merged = !levels_.empty() && levels_.back().has_key && levels_.back().key == "<<";
    if (!merged) refuse(mark, "aliases (*name) are not supported: write the value out");
    YamlNode node = node_at(mark);
    node.refused = true;
    add(std::move(node));
  }
  void OnAnchor(const YAML::Mark& mark, const std::string& name) override {
    refuse(mark, fmt::format("anchors (&{}) are not supported: write the value out", name));
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                const std::string& value) override {
    YamlNode node = node_at(mark);
    node.text = value;
    node.quoted = tag == "!";
    if (node.quoted) refuse_open_quote(mark);
    refuse_tag(mark, tag);
    add(std::move(node));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    open(mark, tag, YamlNode::Kind::kSequence);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    open(mark, tag, YamlNode::Kind::kMap);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Level {
    YamlNode node;
    bool has_key = false;
    std::string key;
    SourcePosition key_position;
    std::unordered_map<std::string, std::size_t> lines;  // of the keys that were read
  };

  static bool kind_is_nothing(const YamlNode& node) {
    return node.kind == YamlNode::Kind::kScalar && node.text.empty() && !node.quoted;
  }

  void refuse(const YAML::Mark& mark, std::string text) {
    document_.mistakes.push_back({position_of(mark), std::move(text)});
  }

  void refuse_tag(const YAML::Mark& mark, const std::string& tag) {
    if (tag.empty() || tag == "!" || tag == "?") return;
    refuse(mark, fmt::format("the tag {} is not supported: leave it out", tag));
  }

  // yaml-cpp's own offset counts differently behind a byte order mark.
  std::size_t offset_of(const YAML::Mark& mark) const {
    const auto line = static_cast<std::size_t>(mark.line);
    if (mark.is_null() || line >= line_starts_.size()) return text_.size();
    return line_starts_[line] + static_cast<std::size_t>(mark.column);
  }

  // yaml-cpp takes the end of the file for a closing quote.
  void refuse_open_quote(const YAML::Mark& mark) {
    const std::size_t start = offset_of(mark);
    if (start >= text_.size() || (text_[start] != '"' && text_[start] != '\'')) return;
    if (end_of_quoted(text_, start) != std::string_view::npos) return;
    refuse(mark, fmt::format("the quote {0} is not closed: end the text with {0}", text_[start]));
  }

  void open(const YAML::Mark& mark, const std::string& tag, YamlNode::Kind kind) {
    refuse_tag(mark, tag);
    levels_.emplace_back().node = node_at(mark, kind);
  }

  void close() {
    YamlNode node = std::move(levels_.back().node);
    levels_.pop_back();
    add(std::move(node));
  }

  void add(YamlNode node) {
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

  void take_key(Level& level, const YamlNode& node) {
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

  void add_member(Level& level, YamlNode node) {
    level.has_key = false;
    // yaml-cpp puts what is not there at the next word, in another line.
    if (kind_is_nothing(node)) node.position = level.key_position;
    const auto [known, is_new] = level.lines.try_emplace(level.key, level.key_position.line);
    if (!is_new) {
      document_.mistakes.push_back(
          {level.key_position, fmt::format("duplicate key \"{}\": it stands in line {} already",
                                           level.key, known->second)});
      return;
    }
    level.node.members.push_back({level.key, level.key_position, std::move(node)});
  }

  YamlDocument& document_;
  std::string_view text_;
  std::vector<std::size_t> line_starts_;
  std::vector<Level> levels_;
  YamlNode root_;
  bool has_root_ = false;
  std::size_t documents_ = 0;
};

SourcePosition end_of(const std::string& text) {
  const std::size_t last = text.find_last_not_of("\r\n");
  if (last == std::string::npos) return {1, 1, {}};
  const std::size_t start = text.rfind('\n', last) + 1;  // npos + 1 is 0
  const auto lines = std::count(text.begin(), text.begin() + static_cast<long>(start), '\n');
  return {static_cast<std::size_t>(lines) + 1, last - start + 2, {}};
}

/// yaml-cpp's messages in words that say what to do.
std::string explain(const std::string& message) {
  constexpr const char* kIndentation =
      "the indentation fits neither the entry above nor the one around it: begin the line in the "
      "column of the entries it belongs to";
  static const std::pair<const char*, const char*> kAdvice[] = {
      {YAML::ErrorMsg::MAP_VALUE,
       "a \":\" cannot stand here: begin the keys of one map in one column, and put a text with "
       "\": \" in it into quotes"},
      {YAML::ErrorMsg::END_OF_MAP, kIndentation},
      {YAML::ErrorMsg::END_OF_SEQ, kIndentation},
      {YAML::ErrorMsg::FLOW_END, "a closing bracket without an opening one: delete it"},
      {YAML::ErrorMsg::UNKNOWN_ANCHOR, "aliases (*name) are not supported: write the value out"},
      // What yaml-cpp says where its recursion would go too deep.
      {YAML::ErrorMsg::BAD_FILE, "lists and maps are nested too deeply here: delete brackets"},
      {YAML::ErrorMsg::UNKNOWN_TOKEN,
       "this character cannot begin a value: put the text into quotes"}};
  for (const auto& [known, advice] : kAdvice) {
    if (message == known) return advice;
  }
  return "not YAML: " + message;
}

// Text that goes on behind a quoted one: of an apostrophe between quotes, or of a quote that was
// left open before.
std::optional<Mistake> text_behind_quotes(const YAML::ParserException& error,
                                          const std::string& text) {
  const bool is_indentation =
      error.msg == YAML::ErrorMsg::END_OF_MAP || error.msg == YAML::ErrorMsg::END_OF_SEQ;
  const std::size_t at = error.mark.is_null() ? 0 : static_cast<std::size_t>(error.mark.pos);
  if (!is_indentation || at == 0 || at >= text.size()) return std::nullopt;
  const char quote = text[at - 1];
  if (quote != '"' && quote != '\'') return std::nullopt;
  return Mistake{
      position_of(error.mark),
      quote == '"'
          ? "a text in quotes ends before this: write \" within it as \\\", or close the "
            "quote that was left open in a line above"
          : "a text in quotes ends before this: write ' within it twice (''), or put the "
            "text between \" and \"; or close the quote that was left open in a line above"};
}

Mistake syntax_mistake(const YAML::ParserException& error, const TreeBuilder& builder,
                       const std::string& text) {
  if (auto behind = text_behind_quotes(error, text)) return *std::move(behind);
  const YamlNode* inner = builder.innermost();
  if (error.msg == YAML::ErrorMsg::MAP_VALUE && !error.mark.is_null()) {
    if (auto above = mistake_above(text, position_of(error.mark).line)) return *std::move(above);
  }
  const bool in_flow =
      error.msg == YAML::ErrorMsg::END_OF_SEQ_FLOW || error.msg == YAML::ErrorMsg::END_OF_MAP_FLOW;
  if (inner != nullptr && in_flow && !error.mark.is_null() && is_closed(text, inner->position)) {
    return {position_of(error.mark),
            "a \",\" is missing before this: entries between brackets are separated by commas"};
  }
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

void parse_yaml_text(YamlDocument& document, const std::string& text, std::size_t skip) {
  if (!is_utf8(document, text) || has_tabs(document, text)) return;
  std::istringstream stream(std::string(skip, ' ') + text.substr(skip));
  TreeBuilder builder(document, text);
  try {
    YAML::Parser parser(stream);
    while (!builder.has_second_document() && parser.HandleNextDocument(builder)) {
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
