// Who is who in a record of a string.
#include <algorithm>

#include "experiments/records/inspection.hpp"
#include "libsim/base/units.hpp"
#include "libsim/base/words.hpp"

namespace modcal {
namespace {

/// Proposes who is who: by name, by unit, else the first channels that have no other role.
class RoleFinder {
 public:
  explicit RoleFinder(const std::vector<ChannelInspection>& channels)
      : channels_(channels), taken_(channels.size(), false) {}

  bool by_name(std::initializer_list<std::string_view> names, RecordedChannelOptions& options) {
    return first(options, [&](const ChannelInspection& channel) { return is_one(channel, names); });
  }
  bool by_name_and_unit(std::initializer_list<std::string_view> names,
                        RecordedChannelOptions& options) {
    return first(options, [&](const ChannelInspection& channel) {
      return is_one(channel, names) && is_unit_of(channel.unit, options.unit);
    });
  }
  /// The first that are left: those in units of force where there are two, else what no unit
  /// tells to be something else.
  void two(RecordOptions& record) {
    constexpr const char* kNoForces[] = {"m", "m/s", "m/s2", "K"};
    const std::size_t forces = forces_left();
    const auto fits = [&](const ChannelInspection& channel) {
      if (forces >= 2) return states_force(channel);
      return std::ranges::none_of(kNoForces,
                                  [&](const char* unit) { return is_unit_of(channel.unit, unit); });
    };
    record.has_left = first(record.left, fits);
    record.has_right = first(record.right, fits);
  }
  /// The only one in units of force that is left.
  bool last_force(RecordedChannelOptions& options) {
    return forces_left() == 1 && first(options, states_force);
  }

 private:
  static bool states_force(const ChannelInspection& channel) {
    return is_unit_of(channel.unit, "N");
  }
  std::size_t forces_left() const {
    std::size_t forces = 0;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      if (!taken_[i] && states_force(channels_[i])) ++forces;
    }
    return forces;
  }
  static bool is_one(const ChannelInspection& channel,
                     std::initializer_list<std::string_view> names) {
    return std::ranges::any_of(names, [&](std::string_view name) {
      return lower_case(channel.name) == lower_case(std::string(name));
    });
  }
  // Takes the first that is left and fits.
  template <typename Fits>
  bool first(RecordedChannelOptions& options, const Fits& fits) {
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      if (taken_[i] || !fits(channels_[i])) continue;
      taken_[i] = true;
      options.channel = channels_[i].name;
      if (!is_unit_of(channels_[i].unit, options.unit)) options.calibration = 1.0;
      return true;
    }
    return false;
  }

  const std::vector<ChannelInspection>& channels_;
  std::vector<bool> taken_;
};

}  // namespace

RecordOptions proposed_roles(const std::filesystem::path& path, const InspectionOptions& options,
                             const std::vector<ChannelInspection>& channels,
                             std::vector<std::string>& warnings) {
  RecordOptions record;
  record.file = path.string();
  record.format = options.format;
  record.sample_rate = options.sample_rate;
  RoleFinder roles(channels);
  record.has_reference =
      roles.by_name({"f_c", "fc", "force", "reference", "bow force"}, record.reference);
  record.has_reference_velocity =
      roles.by_name_and_unit({"v", "v_c", "velocity"}, record.reference_velocity);
  record.has_reference_displacement =
      roles.by_name_and_unit({"y", "y_c", "displacement"}, record.reference_displacement);
  record.has_left = roles.by_name({"R1", "R_1", "left"}, record.left);
  record.has_right = roles.by_name({"R2", "R_2", "right"}, record.right);
  if (!record.has_left && !record.has_right) {
    roles.two(record);
    return record;
  }
  const auto add_other = [&](bool& present, std::string_view role, RecordedChannelOptions& end) {
    if (present || !roles.last_force(end)) return;
    present = true;
    warnings.push_back(
        fmt::format("{}: channel {} is taken for the other end, as the only force "
                    "beside it: leave record.{} out if it is none",
                    record.file, end.channel, role));
  };
  add_other(record.has_left, "left", record.left);
  add_other(record.has_right, "right", record.right);
  return record;
}

}  // namespace modcal
