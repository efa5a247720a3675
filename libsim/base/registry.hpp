// The one place where a YAML name becomes code: a plain table {name, summary, maker} per kind of
// plug-in, sorted by name.
#pragma once

#include <span>

#include "libsim/base/error.hpp"
#include "libsim/base/options.hpp"

namespace modcal {

/// Options of one plug-in together with the way to make it.
template <typename Product>
class Recipe {
 public:
  virtual ~Recipe() = default;
  virtual void visit(OptionVisitor& visitor) = 0;
  virtual std::shared_ptr<const Product> make() const = 0;
  virtual std::unique_ptr<Recipe> clone() const = 0;
};

/// Recipe of a plug-in class that has a nested `Options` with visit() and a constructor from it.
template <typename Product, typename Plugin>
class RecipeOf final : public Recipe<Product> {
 public:
  RecipeOf() = default;
  explicit RecipeOf(typename Plugin::Options options) : options_(std::move(options)) {}
  void visit(OptionVisitor& visitor) override { options_.visit(visitor); }
  std::shared_ptr<const Product> make() const override {
    return std::make_shared<const Plugin>(options_);
  }
  std::unique_ptr<Recipe<Product>> clone() const override {
    return std::make_unique<RecipeOf>(options_);
  }

 private:
  typename Plugin::Options options_;
};

template <typename Product>
struct RegistryEntry {
  std::string_view name;
  std::string_view summary;
  std::unique_ptr<Recipe<Product>> (*recipe)();
};

template <typename Product>
using Registry = std::span<const RegistryEntry<Product>>;

/// Row of a registry table: entry_of<FrictionLaw, ExponentialCoulomb>("name", "summary").
template <typename Product, typename Plugin>
constexpr RegistryEntry<Product> entry_of(std::string_view name, std::string_view summary) {
  return {name, summary, +[]() -> std::unique_ptr<Recipe<Product>> {
            return std::make_unique<RecipeOf<Product, Plugin>>();
          }};
}

/// A plug-in chosen by name with its options: a value that can be copied, visited and made.
/// `Product` declares `static constexpr std::string_view kKind` and `static Registry<Product>
/// registry()`.
template <typename Product>
class Choice final : public PluginSlot {
 public:
  Choice() = default;
  explicit Choice(std::string_view name) { select(name); }
  /// A choice whose options are given in code.
  template <typename Plugin>
  static Choice of(std::string_view name, typename Plugin::Options options) {
    Choice choice(name);
    choice.recipe_ = std::make_unique<RecipeOf<Product, Plugin>>(std::move(options));
    return choice;
  }
  Choice(const Choice& other)
      : entry_(other.entry_), recipe_(other.recipe_ ? other.recipe_->clone() : nullptr) {}
  Choice& operator=(const Choice& other) {
    if (this != &other) {
      entry_ = other.entry_;
      recipe_ = other.recipe_ ? other.recipe_->clone() : nullptr;
    }
    return *this;
  }
  Choice(Choice&&) noexcept = default;
  Choice& operator=(Choice&&) noexcept = default;

  std::string_view kind() const override { return Product::kKind; }
  std::vector<std::string_view> names() const override {
    std::vector<std::string_view> result;
    for (const auto& entry : Product::registry()) result.push_back(entry.name);
    return result;
  }
  std::string_view summary(std::string_view name) const override { return find(name).summary; }
  std::string_view selected() const override { return entry_ ? entry_->name : std::string_view{}; }
  void select(std::string_view name) override {
    entry_ = &find(name);
    recipe_ = entry_->recipe();
  }
  void visit_options(OptionVisitor& visitor) override {
    if (recipe_) recipe_->visit(visitor);
  }
  std::shared_ptr<const Product> make() const {
    MODCAL_REQUIRE(recipe_ != nullptr, "no {} is chosen", Product::kKind);
    return recipe_->make();
  }

 private:
  static const RegistryEntry<Product>& find(std::string_view name) {
    for (const auto& entry : Product::registry()) {
      if (entry.name == name) return entry;
    }
    throw_invalid_input("unknown {} \"{}\"", Product::kKind, name);
  }

  const RegistryEntry<Product>* entry_ = nullptr;
  std::unique_ptr<Recipe<Product>> recipe_;
};

}  // namespace modcal
