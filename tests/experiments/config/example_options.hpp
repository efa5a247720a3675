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
    visitor("low", "lower end", {.unit = "Hz", .required = true}, low);
    visitor("high", "upper end", {.unit = "Hz"}, high);
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
    visitor("string", "the string", string);
    visitor("decay", "decay of friction", {.unit = "s/m"}, decay);
    visitor("stop", "last instant", {.unit = "s", .word = "end"}, stop);
    visitor("share", "a share", {.range = Range::closed(0, 1)}, share);
    visitor("windows", "starts", {.unit = "s", .required = true}, windows);
    visitor("seeds", "seeds", seeds);
    visitor("remove_mean", "remove the mean", remove_mean);
    visitor("note", "a note", note);
    visitor("content", "what is drawn", {.choices = {"waveforms", "spectra"}}, content);
    visitor("quantities", "rows", quantities);
    visitor("band", "a band", has_band, band);
    visitor("bands", "bands", bands);
    visitor("optional_damping", "none by default", optional_damping);
  }
};

inline constexpr std::string_view kString =
    "string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz}\n"
    "windows: [0.7 s]\n";

}  // namespace modcal::testing
