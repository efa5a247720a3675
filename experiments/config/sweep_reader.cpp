#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "experiments/config/help.hpp"
#include "experiments/config/reader.hpp"

namespace modcal {
namespace {

constexpr std::size_t kMostCells = 1000000;

// Axes that vary together: keys of the file with their lists of values.
using Group = std::vector<const YamlNode::Member*>;

std::size_t size_of(const Group& group) { return group.front()->value.items.size(); }

SweepAxis plain(const YamlNode::Member& axis) {
  SweepAxis result{axis.key, {}};
  for (const YamlNode& value : axis.value.items) result.values.push_back(flow_text(value));
  return result;
}

SweepPoint plain(const YamlNode& point) {
  SweepPoint result;
  for (const auto& member : point.members) {
    result.emplace_back(member.key, flow_text(member.value));
  }
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
    name_axes();
    if (!good()) return {};
    std::size_t count = groups_.empty() ? 0 : 1;
    for (const Group& group : groups_) {
      count *= size_of(group);
      if (count <= kMostCells) continue;
      mistake(node_.position, fmt::format("the sweep has more than {} cells", kMostCells));
      return {};
    }
    require_axes();
    if (good()) add_combinations(count);
    add_points();
    if (good() && table_.values.empty())
      mistake(node_.position, "the sweep has no cells left: exclude fewer of them");
    if (good())
      std::ranges::move(mistakes_of(table_, include_.size()), std::back_inserter(mistakes_));
    return good() ? std::move(table_) : SweepTable{};
  }

 private:
  bool good() const { return mistakes_.size() == before_; }
  void mistake(const SourcePosition& place, std::string text) {
    mistakes_.push_back({place, std::move(text)});
  }

  void read_member(const YamlNode::Member& member) {
    if (member.key == "product") {
      for (const YamlNode::Member* axis : read_axes(member.value)) {
        table_.plan.product.push_back(plain(*axis));
        add_group({axis});
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

  // The maps of a list.
  const std::vector<YamlNode>& items_of(const YamlNode::Member& member) {
    if (member.value.kind != YamlNode::Kind::kSequence || member.value.items.empty()) {
      mistake(member.value.position,
              fmt::format("{} needs a list of maps, each beginning with a dash", member.key));
    }
    return member.value.items;
  }

  // Keys below one another are a path; some words are those of a range.
  static constexpr std::string_view kRangeWords[] = {"from", "to",   "start", "stop", "min",
                                                     "max",  "step", "steps", "num",  "by"};
  static std::string why_no_axis(const YamlNode::Member& member) {
    std::string path = member.key;
    const YamlNode* node = &member.value;
    while (node->kind == YamlNode::Kind::kMap && !node->members.empty()) {
      const YamlNode::Member& inner = node->members.front();
      if (std::ranges::count(kRangeWords, inner.key) > 0) {
        return fmt::format("an axis has no range, but a list of its values: write {}: [..., ...]",
                           path);
      }
      path += "." + inner.key;
      node = &inner.value;
    }
    if (node == &member.value) return path + " needs a list of values, at least one";
    return fmt::format("an axis is one path with dots and its values: write {}: [...]", path);
  }

  // Nor is the sweep itself an option of a task.
  bool refuse_no_option(const YamlNode::Member& member) {
    const std::string first = member.key.substr(0, member.key.find('.'));
    if (first != "kind" && first != "title" && first != "description" && first != key_)
      return false;
    mistake(member.position,
            first + " is no axis: no number depends on it; sweep over other options");
    return true;
  }

  Group read_axes(const YamlNode& map) {
    Group axes;
    if (map.kind != YamlNode::Kind::kMap || map.members.empty()) {
      mistake(map.position, "axes are a map of option paths and lists of values");
    }
    for (const YamlNode::Member& member : map.members) {
      if (refuse_no_option(member)) continue;
      if (member.value.kind == YamlNode::Kind::kSequence && !member.value.items.empty()) {
        axes.push_back(&member);
        continue;
      }
      mistake(member.value.position, why_no_axis(member));
    }
    return axes;
  }

  void read_zip(const YamlNode& item) {
    Group group = read_axes(item);
    if (group.empty()) return;
    std::vector<SweepAxis> axes;
    for (const YamlNode::Member* axis : group) {
      if (axis->value.items.size() != size_of(group)) {
        mistake(
            axis->position,
            fmt::format("{} has {} values, {} has {}: values that vary together "
                        "are as many",
                        axis->key, axis->value.items.size(), group.front()->key, size_of(group)));
        return;
      }
      axes.push_back(plain(*axis));
    }
    table_.plan.zip.push_back(std::move(axes));
    add_group(std::move(group));
  }

  // The same values once more are no further draws.
  void add_group(Group group) {
    std::set<std::string> known;
    for (std::size_t i = 0; i < size_of(group); ++i) {
      std::string values;
      for (const YamlNode::Member* axis : group) {
        values += fmt::format("{}{} {}", values.empty() ? "" : ", ", axis->key,
                              flow_text(axis->value.items[i]));
      }
      if (known.insert(values).second) continue;
      mistake(group.front()->value.items[i].position,
              fmt::format("{} stands here twice: leave one of them", values));
      break;  // the first is enough
    }
    groups_.push_back(std::move(group));
  }

  void read_point(const YamlNode& item, std::vector<const YamlNode*>& points,
                  std::vector<SweepPoint>& plan) {
    if (item.kind != YamlNode::Kind::kMap || item.members.empty()) {
      return mistake(item.position, "a cell is a map of option paths and values");
    }
    for (const YamlNode::Member& member : item.members) {
      if (refuse_no_option(member)) return;
    }
    plan.push_back(plain(item));
    points.push_back(&item);
  }

  // Columns of the table: the axes, then what only single cells have.
  void name_axes() {
    for (const Group& group : groups_) {
      for (const YamlNode::Member* axis : group) {
        if (column_of(axis->key) < table_.paths.size()) {
          mistake(axis->position, fmt::format("{} is an axis already", axis->key));
        }
        add_column(*axis);
      }
    }
    axis_columns_ = table_.paths.size();
    for (const YamlNode* point : include_) {
      for (const YamlNode::Member& member : point->members) {
        if (column_of(member.key) == table_.paths.size()) add_column(member);
      }
    }
    table_.order = outer_first(table_.paths);
  }

  void add_column(const YamlNode::Member& member) {
    table_.paths.push_back(member.key);
    table_.places.push_back(member.position);
  }

  std::size_t column_of(const std::string& path) const {
    return static_cast<std::size_t>(std::find(table_.paths.begin(), table_.paths.end(), path) -
                                    table_.paths.begin());
  }

  void require_axes() {
    for (const YamlNode* point : exclude_) {
      for (const YamlNode::Member& member : point->members) {
        if (column_of(member.key) < axis_columns_) continue;
        mistake(point->position,
                fmt::format("{} is no axis; axes: {}", member.key, fmt::join(table_.paths, ", ")));
      }
    }
  }

  void add_combinations(std::size_t count) {
    std::vector<bool> used(exclude_.size(), false);
    for (std::size_t index = 0; index < count; ++index) {
      std::vector<const YamlNode*> cell(table_.paths.size(), nullptr);
      std::size_t rest = index;
      std::size_t column = axis_columns_;
      for (std::size_t g = groups_.size(); g-- > 0;) {
        const Group& group = groups_[g];
        const std::size_t choice = rest % size_of(group);
        rest /= size_of(group);
        for (std::size_t a = group.size(); a-- > 0;)
          cell[--column] = &group[a]->value.items[choice];
      }
      if (!is_excluded(cell, used)) table_.values.push_back(std::move(cell));
    }
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (used[i]) continue;
      mistake(exclude_[i]->position,
              "no cell agrees with this: write the values as they stand on the axes");
    }
  }

  bool is_excluded(const std::vector<const YamlNode*>& cell, std::vector<bool>& used) const {
    bool excluded = false;
    for (std::size_t i = 0; i < exclude_.size(); ++i) {
      const auto& members = exclude_[i]->members;
      const bool agrees = std::all_of(members.begin(), members.end(), [&](const auto& member) {
        return flow_text(*cell[column_of(member.key)]) == flow_text(member.value);
      });
      used[i] = used[i] || agrees;
      excluded = excluded || agrees;
    }
    return excluded;
  }

  void add_points() {
    for (const YamlNode* point : include_) {
      std::vector<const YamlNode*> cell(table_.paths.size(), nullptr);
      for (const auto& member : point->members) cell[column_of(member.key)] = &member.value;
      table_.values.push_back(std::move(cell));
    }
  }

  const YamlNode& node_;
  std::string_view key_;
  std::vector<Mistake>& mistakes_;
  std::size_t before_;
  SweepTable table_;
  std::vector<Group> groups_;
  std::vector<const YamlNode*> exclude_, include_;
  std::size_t axis_columns_ = 0;
};

}  // namespace

SweepTable read_sweep(const YamlNode& node, std::string_view key, std::vector<Mistake>& mistakes) {
  return Reader(node, key, mistakes).read();
}

}  // namespace modcal
