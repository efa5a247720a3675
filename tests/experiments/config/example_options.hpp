// Options of every type, for the tests of their readers and writers.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "libsim/base/registry.hpp"
#include "libsim/model/string_model.hpp"

namespace modcal::testing {

struct Band {
  double low = 0.0;
  double high = 1.0;
  void visit(OptionVisitor& visitor) {
    visitor.number({.key = "low", .meaning = "lower end", .unit = "Hz", .required = true}, low);
    visitor.number({.key = "high", .meaning = "upper end", .unit = "Hz"}, high);
  }
};

struct ExampleOptions {
  StringModel string;
  double decay = 5.0;
  double stop = std::numeric_limits<double>::quiet_NaN();
  double share = 0.1 + 0.2;
  std::vector<double> windows = {0.7, 0.78};
  std::vector<std::int64_t> seeds = {1, 2};
  bool remove_mean = true;
  std::string note = "plain: \"quoted\" # no comment\nµ";
  std::string content = "waveforms";
  std::vector<std::string> quantities = {"y", "null", "010"};
  bool has_band = false;
  Band band;
  std::vector<Band> bands;
  Choice<DampingLaw> optional_damping;

  void visit(OptionVisitor& visitor) {
    visitor.section({.key = "string", .meaning = "the string"}, string);
    visitor.number({.key = "decay", .meaning = "decay of friction", .unit = "s/m"}, decay);
    visitor.number({.key = "stop", .meaning = "last instant", .unit = "s", .word = "end"}, stop);
    visitor.number({.key = "share", .meaning = "a share", .range = Range::closed(0, 1)}, share);
    visitor.numbers({.key = "windows", .meaning = "starts", .unit = "s", .required = true},
                    windows);
    visitor.integers({.key = "seeds", .meaning = "seeds"}, seeds);
    visitor.flag({.key = "remove_mean", .meaning = "remove the mean"}, remove_mean);
    visitor.text({.key = "note", .meaning = "a note"}, note);
    visitor.text(
        {.key = "content", .meaning = "what is drawn", .choices = {"waveforms", "spectra"}},
        content);
    visitor.texts({.key = "quantities", .meaning = "rows"}, quantities);
    visitor.optional_group({.key = "band", .meaning = "a band"}, has_band,
                           [this](OptionVisitor& members) { band.visit(members); });
    ListOf<Band> list(bands);
    visitor.list({.key = "bands", .meaning = "bands"}, list);
    visitor.plugin({.key = "optional_damping", .meaning = "none by default"}, optional_damping);
  }
};

inline constexpr std::string_view kString =
    "string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz}\n"
    "windows: [0.7 s]\n";

}  // namespace modcal::testing
