// The file of a structure's modes.
#include "experiments/kinds/structure/structure_files.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace modcal;
  const fuzz::MemoryFile file(fuzz::text_of(data, size));
  StructureTable table;
  if (!fuzz::accepted([&] { table = read_table(file.path()); })) return 0;
  fuzz::require(table.model.pairs() == table.names.size(), "not one model a sensor");
  fuzz::require(table.model.constants.size() == table.names.size() * table.model.poles.size(),
                "not one constant a sensor and mode");
  // What is written out reads back to the same.
  const std::string text = table_text(table);
  const fuzz::MemoryFile written(text);
  fuzz::require(table_text(read_table(written.path())) == text, "reads back to something else");
  return 0;
}
