// The kinds of plug-in that `list` and `describe` know.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "libsim/base/options.hpp"

namespace modcal {

struct PluginKind {
  std::string_view name;
  std::string_view summary;
  std::unique_ptr<PluginSlot> (*slot)();
};

std::span<const PluginKind> plugin_kinds();
/// Throws InvalidInput with the nearest name where there is no such kind.
const PluginKind& find_plugin_kind(std::string_view name);

}  // namespace modcal
