// A journal. A line that begins with "=" gets the checksum that the rest of it needs: no search
// finds one.
#include <sstream>

#include "experiments/runs/journal.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace modcal::fuzz {
namespace {

std::string with_checksums(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    if (line.starts_with('=')) result += checksum_of(line.substr(1)) + " ";
    result += line.substr(line.starts_with('=') ? 1 : 0);
    if (end < text.size()) result += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

// Number of records; what is read again by its place is the same.
std::size_t records_in(const MemoryFile& file, const std::string& content,
                       std::vector<JournalDamage>& damages) {
  std::size_t records = 0;
  scan_journal(
      file.path(),
      [&](const JournalRecord& record, std::uint64_t offset, std::size_t length) {
        ++records;
        const JournalRecord again =
            record_of_line(file.path(), std::string_view(content).substr(offset, length));
        require(again.key == record.key && again.outcome == record.outcome, "another record");
      },
      damages);
  return records;
}

}  // namespace
}  // namespace modcal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace modcal;
  const std::string content = fuzz::with_checksums(fuzz::text_of(data, size));
  const fuzz::MemoryFile file(content);
  std::vector<JournalDamage> damages;
  std::size_t records = 0;
  if (!fuzz::accepted([&] { records = fuzz::records_in(file, content, damages); })) return 0;
  for (const JournalDamage& damage : damages) {
    fuzz::require(!message_of(damage).empty() && damage.offset < content.size(), "a wrong place");
  }
  // What is appended is found, whatever stood before.
  const std::string end = content.empty() || content.ends_with('\n') ? "" : "\n";
  const std::string line = "0123456789abcdef0123456789abcdef 7 0.5 {}";
  const std::string longer = content + end + checksum_of(line) + " " + line + "\n";
  const fuzz::MemoryFile longer_file(longer);
  damages.clear();
  fuzz::require(fuzz::records_in(longer_file, longer, damages) == records + 1,
                "an appended record is lost");
  return 0;
}
