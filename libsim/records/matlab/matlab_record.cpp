#include <cctype>
#include <optional>

#include "libsim/base/error.hpp"
#include "libsim/records/matlab/matlab_content.hpp"
#include "libsim/records/matlab/matlab_file.hpp"
#include "libsim/records/stored_channels.hpp"

namespace modcal {
namespace {

using Path = std::filesystem::path;
using Leaf = MatlabLeaf;
using Content = MatlabContent;

std::string last_of(const Leaf& leaf) {
  std::string name = leaf.path.back();
  for (char& letter : name) {
    letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  return name;
}

bool is_one_of(const std::string& name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// How many names lead to the structure that both stand in, where it is all of the second's; the
// axis of a signal often stands in a structure x_values beside it.
std::optional<std::size_t> scope(const Leaf& leaf, const Leaf& of) {
  std::size_t depth = of.path.size() - 1;
  if (depth > 0 && of.path[depth - 1] == "x_values") --depth;
  const bool inside =
      leaf.path.size() > depth &&
      std::equal(of.path.begin(), of.path.begin() + static_cast<long>(depth), leaf.path.begin());
  return inside ? std::optional(depth) : std::nullopt;
}

// The one that tells of a leaf, from the nearest structure; null: none.
template <typename Tells>
const Leaf* nearest(const std::vector<Leaf>& leaves, const Leaf& leaf, Tells tells) {
  const Leaf* best = nullptr;
  for (const Leaf& other : leaves) {
    if (!tells(other) || !scope(leaf, other)) continue;
    if (best == nullptr || *scope(leaf, other) > *scope(leaf, *best)) best = &other;
  }
  return best;
}

bool is_time(const Leaf& leaf) { return is_one_of(last_of(leaf), {"t", "time"}); }
bool is_rate(const Leaf& leaf) {
  return leaf.size() == 1 && leaf.is_real() &&
         is_one_of(last_of(leaf), {"sample_rate", "samplerate", "sampling_rate", "samplingrate",
                                   "sample_frequency", "sampling_frequency", "fs"});
}
bool is_period(const Leaf& leaf) {
  return leaf.size() == 1 && leaf.is_real() &&
         is_one_of(last_of(leaf), {"dt", "ts", "increment", "sample_period", "delta_t"});
}

void set_rate(const std::shared_ptr<Content>& content, const Leaf& leaf, StoredChannel& channel) {
  const std::vector<Leaf>& leaves = content->leaves();
  const auto tells = [](const Leaf& other) { return is_rate(other) || is_period(other); };
  if (const Leaf* const told = nearest(leaves, leaf, tells)) {
    const double value = content->number(*told);
    channel.sample_rate =
        is_rate(*told) ? value : rate_of_period(value, std::numeric_limits<double>::epsilon());
    channel.rate_source = fmt::format("{} = {:.9g}", told->text(), value);
    return;
  }
  const Leaf* const time = nearest(leaves, leaf, [&leaf](const Leaf& other) {
    return is_time(other) && other.is_real() && other.is_table() && other.columns() == 1 &&
           other.rows() == leaf.rows();
  });
  if (time == nullptr) return;
  channel.read_times = [content, time = *time] { return content->column(time, 0); };
  channel.time_resolution = time->type == MAT_C_SINGLE
                                ? static_cast<double>(std::numeric_limits<float>::epsilon())
                                : std::numeric_limits<double>::epsilon();
}

// Names and units as write_matlab() left them.
void set_own_head(const std::shared_ptr<Content>& content, const Leaf& leaf,
                  RecordedChannel& head) {
  for (const Leaf& other : content->leaves()) {
    if (other.path.size() != 3 || other.path[0] != kMatlabHeads || other.path[1] != leaf.path[0] ||
        other.type != MAT_C_CHAR) {
      continue;
    }
    (is_one_of(other.path[2], {"unit"}) ? head.unit : head.name) = content->text(other);
  }
}

void add_channels(const std::shared_ptr<Content>& content, const Path& path, const Leaf& leaf,
                  std::vector<StoredChannel>& channels) {
  const bool is_plain = leaf.is_real() && leaf.is_table();
  const std::size_t count = is_plain ? leaf.columns() : 1;
  for (std::size_t j = 0; j < count; ++j) {
    StoredChannel channel;
    channel.head.name = leaf.text();
    if (count > 1) channel.head.name += fmt::format("_{}", j + 1);
    channel.place = fmt::format("{}: {}", path.string(), channel.head.name);
    channel.size = is_plain ? leaf.rows() : leaf.size();
    if (!is_plain) {
      channel.other_than_time = fmt::format(
          "{}array of {} values", leaf.is_complex ? "complex " : "", fmt::join(leaf.dims, " × "));
    } else {
      set_rate(content, leaf, channel);
      if (leaf.path.size() == 1 && count == 1) set_own_head(content, leaf, channel.head);
      channel.read = [content, leaf, j] { return content->column(leaf, j); };
    }
    channels.push_back(std::move(channel));
  }
}

}  // namespace

Recording read_matlab(const Path& path, const ReadOptions& options) {
  const auto content = std::make_shared<Content>(path);
  std::vector<StoredChannel> channels;
  for (const Leaf& leaf : content->leaves()) {
    const bool may_be_channel = leaf.has_numbers() && leaf.size() > 1;
    if (may_be_channel && !is_time(leaf)) add_channels(content, path, leaf, channels);
  }
  MODCAL_REQUIRE(!channels.empty(), "{}: no vector of numbers stands in this MAT file",
                 path.string());
  const std::size_t count = channels.size();
  return assemble(fmt::format("MAT file, {} channel{}", count, count == 1 ? "" : "s"),
                  std::move(channels), options, path.string());
}

}  // namespace modcal
