// Meanings of keys written beside them.
#include <fmt/format.h>

#include "experiments/config/help.hpp"

namespace modcal {
namespace {

using Json = nlohmann::ordered_json;

// A line of YAML with a key of its own.
struct KeyLine {
  std::size_t indent = 0;  // of the key, behind the mark of a list
  std::string key;
};

// Without a key: comments, list items that are values.
std::optional<KeyLine> key_line_of(const std::string& line) {
  const std::size_t begin = line.find_first_not_of(" -");
  if (begin == std::string::npos || line[begin] == '#') return std::nullopt;
  const std::size_t end = line.find(':', begin);
  const bool is_key =
      end != std::string::npos &&
      line.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_", begin) == end;
  if (!is_key) return std::nullopt;
  return KeyLine{begin, line.substr(begin, end - begin)};
}

// The options below a path of keys; null: nothing is known of it.
const Json* entry_of(const Json& options, const std::vector<KeyLine>& path) {
  const Json* below = &options;
  const Json* entry = nullptr;
  for (const KeyLine& one : path) {
    if (below == nullptr) return nullptr;
    entry = nullptr;
    for (const Json& option : *below) {
      if (option.at("key") == one.key) entry = &option;
    }
    if (entry == nullptr) return nullptr;
    below = entry->contains("options") ? &entry->at("options") : nullptr;
  }
  return entry;
}

}  // namespace

std::string commented(const std::string& yaml, const Json& options) {
  constexpr std::size_t kShort = 60;  // a comment behind a longer line is not seen
  std::string text;
  std::vector<KeyLine> path;
  bool explained = false;  // by a comment that stands there
  for (std::size_t at = 0; at < yaml.size();) {
    const std::size_t end = std::min(yaml.find('\n', at), yaml.size());
    const std::string line = yaml.substr(at, end - at);
    at = end + 1;
    const auto key = key_line_of(line);
    const bool is_told = std::exchange(explained, line.starts_with('#') && !path.empty());
    if (key) {
      while (!path.empty() && path.back().indent >= key->indent) path.pop_back();
      path.push_back(*key);
    }
    const Json* entry = key && !is_told ? entry_of(options, path) : nullptr;
    if (entry == nullptr || line.find(" #") != std::string::npos) {
      text += line + "\n";
      continue;
    }
    const std::string meaning = entry->at("meaning").get<std::string>();
    text += line.size() < kShort
                ? fmt::format("{}  # {}\n", line, meaning)
                : fmt::format("{}# {}\n{}\n", std::string(line.find_first_not_of(' '), ' '),
                              meaning, line);
  }
  return text;
}

}  // namespace modcal
