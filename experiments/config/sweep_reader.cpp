#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "experiments/config/reader.hpp"
#include "experiments/config/resolved.hpp"

namespace modcal {
namespace {

constexpr std::size_t kMostCells = 1000000;

// One column of the table: a path with its values.
struct Axis {
  std::string path;
  SourcePosition place;
  std::vector<const YamlNode*> values;
};

// Axes that vary together.
using Group = std::vector<Axis>;

using Point = std::vector<std::pair<std::string, const YamlNode*>>;

SweepAxis plain(const Axis& axis) {
  SweepAxis result{axis.path, {}};
  for (const YamlNode* value : axis.values) result.values.push_back(flow_text(*value));
  return result;
}

SweepPoint plain(const Point& point) {
  SweepPoint result;
  for (const auto& [path, value] : point) result.emplace_back(path, flow_text(*value));
  return result;
}

class Reader {
 public:
  Reader(const YamlNode& node, std::string_view key, std::vector<Mistake>& mistakes)
      : node_(node), key_(key), mistakes_(mistakes), before_(mistakes.size()) {}

  SweepTable read() {
    for (const YamlNode::Member& member : node_.members) read_member(member);
    if (node_.kind != YamlNode::Kind::kMap || (groups_.empty() && include_.empty() && good())) {
      mistake(node_.position, fmt::format("{} needs a product, a zip or an include: maps of option "
                                          "paths and their values",
                                          key_));
    }
    require_different_paths();
    if (!good()) return {};
    name_columns();
    std::size_t count = groups_.empty() ? 0 : 1;
    for (const Group& group : groups_) {
      count *= group.front().values.size();
      if (count <= kMostCells) continue;
      mistake(node_.position, fmt::format("the sweep has more than {} cells", kMostCells));
      return {};
    }
    add_combinations(count);
    add_points();
    if (good() && table_.values.empty()) mistake(node_.position, "the sweep has no cells left");
    return good() ? std::move(table_) : SweepTable{};
  }

 private:
  bool good() const { return mistakes_.size() == before_; }
  void mistake(const SourcePosition& place, std::string text) {
    mistakes_.push_back({place, std::move(text)});
  }

  void read_member(const YamlNode::Member& member) {
    if (member.key == "product") {
      for (Axis& axis : read_axes(member.value)) {
        table_.plan.product.push_back(plain(axis));
        groups_.push_back({std::move(axis)});
      }
    } else if (member.key == "zip") {
      for (const YamlNode& item : items_of(member)) read_zip(item);
    } else if (member.key == "exclude") {
      for (const YamlNode& item : items_of(member)) read_point(item, exclude_, table_.plan.exclude);
    } else if (member.key == "include") {
      for (const YamlNode& item : items_of(member)) read_point(item, include_, table_.plan.include);
    } else {
      mistake(member.position,
              fmt::format("unknown key \"{}\"; known: product, zip, exclude, include", member.key));
    }
  }

  // The maps of a list; one map alone stands for a list of one.
  std::vector<YamlNode> const& items_of(const YamlNode::Member& member) {
    if (member.value.kind == YamlNode::Kind::kSequence && !member.value.items.empty()) {
      return member.value.items;
    }
    mistake(member.value.position,
            fmt::format("{} needs a list of maps, each beginning with a dash", member.key));
    static const std::vector<YamlNode> kNone;
    return kNone;
  }

  std::vector<Axis> read_axes(const YamlNode& map) {
    std::vector<Axis> axes;
    if (map.kind != YamlNode::Kind::kMap || map.members.empty()) {
      mistake(map.position, "axes are a map of option paths and lists of values");
    }
    for (const YamlNode::Member& member : map.members) {
      if (member.value.kind != YamlNode::Kind::kSequence || member.value.items.empty()) {
        mistake(member.value.position,
                fmt::format("{} needs a list of values, at least one", member.key));
        continue;
      }
      Axis axis{member.key, member.position, {}};
      for (const YamlNode& item : member.value.items) axis.values.push_back(&item);
      axes.push_back(std::move(axis));
    }
    return axes;
  }

  void read_zip(const YamlNode& item) {
    Group group = read_axes(item);
    if (group.empty()) return;
    const std::size_t length = group.front().values.size();
    std::vector<SweepAxis> axes;
    for (const Axis& axis : group) {
      if (axis.values.size() != length) {
        mistake(axis.place,
                fmt::format("{} has {} values, {} has {}: values that vary together are "
                            "as many",
                            axis.path, axis.values.size(), group.front().path, length));
        return;
      }
      axes.push_back(plain(axis));
    }
    table_.plan.zip.push_back(std::move(axes));
    groups_.push_back(std::move(group));
  }

  void read_point(const YamlNode& item, std::vector<std::pair<const YamlNode*, Point>>& points,
                  std::vector<SweepPoint>& plan) {
    if (item.kind != YamlNode::Kind::kMap || item.members.empty()) {
      return mistake(item.position, "a cell is a map of option paths and values");
    }
    Point point;
    for (const YamlNode::Member& member : item.members) {
      point.emplace_back(member.key, &member.value);
      if (&points == &include_) include_places_.emplace_back(member.key, member.position);
    }
    plan.push_back(plain(point));
    points.emplace_back(&item, std::move(point));
  }

  void require_different_paths() {
    std::vector<std::string> known;
    for (const Group& group : groups_) {
      for (const Axis& axis : group) {
        if (std::find(known.begin(), known.end(), axis.path) != known.end()) {
          mistake(axis.place, fmt::format("{} is an axis already", axis.path));
        }
        known.push_back(axis.path);
      }
    }
  }

  void name_columns() {
    for (const Group& group : groups_) {
      for (const Axis& axis : group) {
        table_.paths.push_back(axis.path);
        table_.places.push_back(axis.place);
      }
    }
    for (const auto& [path, place] : include_places_) {
      if (column_of(path) < table_.paths.size()) continue;
      table_.paths.push_back(path);
      table_.places.push_back(place);
    }
  }

  std::size_t column_of(const std::string& path) const {
    return static_cast<std::size_t>(std::find(table_.paths.begin(), table_.paths.end(), path) -
                                    table_.paths.begin());
  }

  void add_combinations(std::size_t count) {
    require_known_columns();
    if (!good()) return;
    std::vector<bool> used(exclude_.size(), false);
    for (std::size_t index = 0; index < count; ++index) {
      std::vector<const YamlNode*> cell(table_.paths.size(), nullptr);
      std::size_t rest = index;
      std::size_t column = axis_columns();
      for (std::size_t g = groups_.size(); g-- > 0;) {
        const Group& group = groups_[g];
        const std::size_t choice = rest % group.front().values.size();
        rest /= group.front().values.size();
        for (std::size_t a = group.size(); a-- > 0;) cell[--column] = group[a].values[choice];
      }
      if (!is_excluded(cell, used)) table_.values.push_back(std::move(cell));
    }
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (used[i]) continue;
      mistake(exclude_[i].first->position,
              "no cell agrees with this: write the values as they stand on the axes");
    }
  }

  std::size_t axis_columns() const {
    std::size_t count = 0;
    for (const Group& group : groups_) count += group.size();
    return count;
  }

  void require_known_columns() {
    for (const auto& [node, point] : exclude_) {
      for (const auto& [path, value] : point) {
        if (column_of(path) < axis_columns()) continue;
        mistake(node->position,
                fmt::format("{} is no axis; axes: {}", path, fmt::join(table_.paths, ", ")));
      }
    }
  }

  bool is_excluded(const std::vector<const YamlNode*>& cell, std::vector<bool>& used) const {
    bool excluded = false;
    for (std::size_t i = 0; i < exclude_.size(); ++i) {
      const Point& point = exclude_[i].second;
      const bool agrees = std::all_of(point.begin(), point.end(), [&](const auto& part) {
        return flow_text(*cell[column_of(part.first)]) == flow_text(*part.second);
      });
      used[i] = used[i] || agrees;
      excluded = excluded || agrees;
    }
    return excluded;
  }

  void add_points() {
    for (const auto& [node, point] : include_) {
      std::vector<const YamlNode*> cell(table_.paths.size(), nullptr);
      for (const auto& [path, value] : point) cell[column_of(path)] = value;
      table_.values.push_back(std::move(cell));
    }
  }

  const YamlNode& node_;
  std::string_view key_;
  std::vector<Mistake>& mistakes_;
  std::size_t before_;
  SweepTable table_;
  std::vector<Group> groups_;
  std::vector<std::pair<const YamlNode*, Point>> exclude_, include_;
  std::vector<std::pair<std::string, SourcePosition>> include_places_;
};

}  // namespace

SweepCells SweepTable::cells() const {
  SweepCells result{paths, {}};
  for (const std::vector<const YamlNode*>& cell : values) {
    std::vector<std::string> texts;
    for (const YamlNode* value : cell) {
      texts.push_back(value == nullptr ? std::string() : flow_text(*value));
    }
    result.values.push_back(std::move(texts));
  }
  return result;
}

SweepTable read_sweep(const YamlNode& node, std::string_view key, std::vector<Mistake>& mistakes) {
  return Reader(node, key, mistakes).read();
}

}  // namespace modcal
