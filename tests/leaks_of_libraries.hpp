// What libraries keep of damaged input, which LeakSanitizer need not tell: libudunits2 some bytes
// of a unit that it does not know, libhdf5 what it had read before it gave up.
#pragma once

// Called by the run-time library alone, which gives the name.
// NOLINTNEXTLINE(bugprone-reserved-identifier)
extern "C" [[gnu::used]] inline const char* __lsan_default_suppressions() {
  return "leak:libudunits2\nleak:libhdf5";
}
