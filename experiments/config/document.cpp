#include "experiments/config/document.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "experiments/config/yaml_text.hpp"
#include "libsim/base/error.hpp"

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

std::filesystem::path YamlDocument::folder() const {
  return std::filesystem::path(file).parent_path();
}

YamlDocument parse_yaml(const std::string& source, std::string file) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  const std::string text =
      source.starts_with(kByteOrderMark) ? source.substr(kByteOrderMark.size()) : source;
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
  MODCAL_REQUIRE(!std::filesystem::is_directory(path), "{}: this is a folder, not a file",
                 path.string());
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  MODCAL_REQUIRE(stream.is_open(), "{}: cannot be opened: {}; check the path and its permissions",
                 path.string(), std::strerror(errno));
  std::ostringstream content;
  content << stream.rdbuf();
  return parse_yaml(content.str(), path.string());
}

}  // namespace modcal
