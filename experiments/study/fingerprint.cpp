#include "experiments/study/fingerprint.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <system_error>

namespace modcal {
namespace {

class FingerprintWriter final : public OptionVisitor {
 public:
  std::string line;

  void number(const OptionInfo& info, double& value) override {
    add(info, fmt::format("{:a}", value));
  }
  void numbers(const OptionInfo& info, std::vector<double>& values) override {
    add(info, fmt::format("{:a}", fmt::join(values, ",")));
  }
  void integer(const OptionInfo& info, std::int64_t& value) override {
    add(info, fmt::format("{}", value));
  }
  void integers(const OptionInfo& info, std::vector<std::int64_t>& values) override {
    add(info, fmt::format("{}", fmt::join(values, ",")));
  }
  void flag(const OptionInfo& info, bool& value) override { add(info, value ? "true" : "false"); }
  void text(const OptionInfo& info, std::string& value) override {
    add(info, fmt::format("{}:{}", value.size(), value));
  }
  void texts(const OptionInfo& info, std::vector<std::string>& values) override {
    for (std::string& value : values) text(info, value);
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

std::string record_fingerprint(const std::filesystem::path& file) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  if (error) return " missing";
  const auto changed = std::filesystem::last_write_time(file, error);
  return fmt::format(" {} {}", size, changed.time_since_epoch().count());
}

}  // namespace modcal
