// Builds a document's tree from the events of yaml-cpp's parser.
#pragma once

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/mark.h>

#include <string>
#include <string_view>
#include <vector>

#include "experiments/config/document.hpp"

namespace modcal {

SourcePosition position_of(const YAML::Mark& mark);

/// Unlike YAML::Node, events show duplicate keys, anchors and the place of every key. What is
/// refused becomes a mistake of `document`.
class TreeBuilder final : public YAML::EventHandler {
 public:
  /// `text`: what is parsed, for what yaml-cpp does not see.
  TreeBuilder(YamlDocument& document, std::string_view text) : document_(document), text_(text) {}

  bool has_root() const { return has_root_; }
  YamlNode take_root() { return std::move(root_); }
  /// The list or map that is open where parsing stopped; null at the top.
  const YamlNode* innermost() const { return levels_.empty() ? nullptr : &levels_.back().node; }

  void OnDocumentStart(const YAML::Mark& mark) override;
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override;
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override;
  void OnAnchor(const YAML::Mark& mark, const std::string& name) override;
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override;
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value style) override;
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value style) override;
  void OnMapEnd() override { close(); }

 private:
  struct Level {
    YamlNode node;
    bool has_key = false;
    std::string key;
    SourcePosition key_position;
  };

  void refuse(const YAML::Mark& mark, std::string text);
  void refuse_tag(const YAML::Mark& mark, const std::string& tag);
  void refuse_open_quote(const YAML::Mark& mark);
  void open(const YAML::Mark& mark, const std::string& tag, YamlNode::Kind kind);
  void close();
  void add(YamlNode node);
  void take_key(Level& level, const YamlNode& node);
  void add_member(Level& level, YamlNode node);

  YamlDocument& document_;
  std::string_view text_;
  std::vector<Level> levels_;
  YamlNode root_;
  bool has_root_ = false;
  std::size_t documents_ = 0;
};

}  // namespace modcal
