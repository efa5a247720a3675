#include "experiments/study/study.hpp"

namespace modcal {

void StudyResult::state_command(const std::string& command) {
  for (report::Block& block : blocks) {
    std::visit(
        [&command](auto& item) {
          if constexpr (requires { item.command; }) {
            if (item.command.empty()) item.command = command;
          }
        },
        block);
  }
}

}  // namespace modcal
