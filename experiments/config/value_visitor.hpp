#pragma once

#include <variant>

#include "libsim/base/options.hpp"

namespace modcal {

/// The value of an option, or the list of values.
using OptionValue = std::variant<double*, std::int64_t*, bool*, std::string*, std::vector<double>*,
                                 std::vector<std::int64_t>*, std::vector<std::string>*>;

/// Type of the values of a list, or of a value that stands alone.
template <typename Value>
struct ItemOf {
  using Type = Value;
};
template <typename Item>
struct ItemOf<std::vector<Item>> {
  using Type = Item;
};

/// Visitor to which every single value and every list of them is one thing.
class ValueVisitor : public OptionVisitor {
 public:
  virtual void value(const OptionInfo& info, OptionValue value) = 0;

  void number(const OptionInfo& info, double& held) final { value(info, &held); }
  void numbers(const OptionInfo& info, std::vector<double>& held) final { value(info, &held); }
  void integer(const OptionInfo& info, std::int64_t& held) final { value(info, &held); }
  void integers(const OptionInfo& info, std::vector<std::int64_t>& held) final {
    value(info, &held);
  }
  void flag(const OptionInfo& info, bool& held) final { value(info, &held); }
  void text(const OptionInfo& info, std::string& held) final { value(info, &held); }
  void texts(const OptionInfo& info, std::vector<std::string>& held) final { value(info, &held); }
};

}  // namespace modcal
