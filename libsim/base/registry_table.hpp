// The table of a registry: the library's rows, and those that a program adds while it runs.
#pragma once

#include <array>
#include <atomic>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "libsim/base/registry.hpp"

namespace modcal {

/// Rows stay where they are for the life of the process; they may be read while one is added.
template <typename Product>
class RegistryTable {
 public:
  RegistryTable(std::initializer_list<RegistryEntry<Product>> rows) : rows_(rows) {
    count_ = rows_.size();
    rows_.resize(rows_.size() + kMost);
  }
  Registry<Product> rows() const { return {rows_.data(), count_.load(std::memory_order_acquire)}; }

  /// A plug-in without options. Throws InvalidInput for an empty name, one that is taken, and for
  /// more than kMost.
  void add(std::string name, std::string summary, std::shared_ptr<const Product> product) {
    const std::lock_guard lock(mutex_);
    MODCAL_REQUIRE(!name.empty(), "the name of the {} is empty: give it one", Product::kKind);
    for (const auto& row : rows()) {
      MODCAL_REQUIRE(row.name != name, "the {} \"{}\" is there already: take another name",
                     Product::kKind, name);
    }
    MODCAL_REQUIRE(added_ < kMost, "more than {} {}s of one's own", kMost, Product::kKind);
    Own& own = owns()[added_];
    own = {std::move(name), std::move(summary), std::move(product)};
    const std::size_t count = count_.load();
    rows_[count] = {own.name, own.summary, makers(std::make_index_sequence<kMost>())[added_++]};
    count_.store(count + 1, std::memory_order_release);
  }

 private:
  enum : std::size_t { kMost = 16 };
  struct Own {
    std::string name, summary;
    std::shared_ptr<const Product> product;
  };
  // Never destroyed: what it holds may need an interpreter that has ended by then.
  static std::array<Own, kMost>& owns() {
    static auto* const all = new std::array<Own, kMost>();
    return *all;
  }
  class OwnRecipe final : public Recipe<Product> {
   public:
    explicit OwnRecipe(std::shared_ptr<const Product> product) : product_(std::move(product)) {}
    void visit(OptionVisitor& /*visitor*/) override {}
    std::shared_ptr<const Product> make() const override { return product_; }
    std::unique_ptr<Recipe<Product>> clone() const override {
      return std::make_unique<OwnRecipe>(product_);
    }

   private:
    std::shared_ptr<const Product> product_;
  };
  // A row makes its recipe by a function without arguments.
  template <std::size_t... kPlace>
  static auto makers(std::index_sequence<kPlace...> /*places*/) {
    return std::array{+[]() -> std::unique_ptr<Recipe<Product>> {
      return std::make_unique<OwnRecipe>(owns()[kPlace].product);
    }...};
  }

  std::vector<RegistryEntry<Product>> rows_;
  std::atomic<std::size_t> count_{0};
  std::size_t added_ = 0;
  std::mutex mutex_;
};

}  // namespace modcal
