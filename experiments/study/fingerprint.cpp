#include "experiments/study/fingerprint.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "libsim/base/options.hpp"

namespace modcal {
namespace {

class FingerprintWriter final : public OptionVisitor {
 public:
  std::string line;

  void value(const OptionInfo& info, OptionValue value) override {
    std::visit([&](const auto* held) { write(info, *held); }, value);
  }
  void plugin(const OptionInfo& info, PluginSlot& slot) override {
    add(info, std::string(slot.selected()));
    line += '{';
    slot.visit_options(*this);
    line += '}';
  }
  void group(const OptionInfo& info, const VisitMembers& visit_members) override {
    add(info, "{");
    visit_members(*this);
    line += '}';
  }
  void optional_group(const OptionInfo& info, bool& present,
                      const VisitMembers& visit_members) override {
    if (present) group(info, visit_members);
  }
  void list(const OptionInfo& info, ListSlot& slot) override {
    add(info, fmt::format("[{}", slot.size()));
    for (std::size_t i = 0; i < slot.size(); ++i) slot.visit_item(i, *this);
    line += ']';
  }
  void sweep(const OptionInfo& /*info*/, SweepSlot& /*slot*/) override {}

 private:
  template <typename Value>
  void write(const OptionInfo& info, const Value& value) {
    if constexpr (std::is_same_v<Value, std::vector<std::string>>) {
      for (const std::string& text : value) write(info, text);
    } else if constexpr (std::is_same_v<Value, std::string>) {
      add(info, fmt::format("{}:{}", value.size(), value));
    } else if constexpr (std::is_same_v<Value, double>) {
      add(info, fmt::format("{:a}", value));
    } else if constexpr (std::is_same_v<Value, std::vector<double>>) {
      add(info, fmt::format("{:a}", fmt::join(value, ",")));
    } else if constexpr (std::is_integral_v<Value>) {
      add(info, fmt::format("{}", value));
    } else {
      add(info, fmt::format("{}", fmt::join(value, ",")));
    }
  }

  void add(const OptionInfo& info, const std::string& value) {
    line += fmt::format("{}={};", info.key, value);
  }
};

}  // namespace

std::string fingerprint(const std::function<void(OptionVisitor&)>& visit_options) {
  FingerprintWriter writer;
  visit_options(writer);
  return writer.line;
}

}  // namespace modcal
