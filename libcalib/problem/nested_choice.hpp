// A plug-in inside another one of its kind.
#pragma once

#include "libsim/base/registry.hpp"

namespace modcal {

/// Choice of any plug-in of a kind but the one it stands in, named by `Outer::kName`, whose
/// `Outer::kNested` says what to write in its place.
template <typename Product, typename Outer>
class NestedChoice final : public PluginSlot {
 public:
  NestedChoice() = default;
  explicit NestedChoice(std::string_view name) : choice_(name) {}
  std::string_view kind() const override { return choice_.kind(); }
  std::vector<std::string_view> names() const override {
    std::vector<std::string_view> all = choice_.names();
    std::erase(all, Outer::kName);
    return all;
  }
  std::string_view summary(std::string_view name) const override { return choice_.summary(name); }
  std::string_view selected() const override { return choice_.selected(); }
  void select(std::string_view name) override { assign(Choice<Product>(name)); }
  void visit_options(OptionVisitor& visitor) override { choice_.visit_options(visitor); }
  std::shared_ptr<const Product> make() const { return choice_.make(); }
  /// A choice whose options are given in code. Throws InvalidInput for the one it stands in.
  void assign(Choice<Product> choice) {
    MODCAL_REQUIRE(choice.selected() != Outer::kName, "a {0} in a {0}: {1}", Outer::kName,
                   Outer::kNested);
    choice_ = std::move(choice);
  }

 private:
  Choice<Product> choice_;
};

}  // namespace modcal
