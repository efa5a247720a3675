// Every configuration at its test size: the same bits for 1, 2 and 8 threads, and the numbers of
// digests.txt for every instruction set of the kernels (MODCAL_INSTRUCTIONS).
//
// digests.txt has a line a quantity, "config quantity count digest scale": the digest is the sum of
// w_i x_i with weights of the places, the scale that of |x_i|, so that a change of any x_i shows,
// and one of rounding is no more than it is. Before, a line a config: "config largest", the largest
// |digest - digest'| / scale between instruction sets that was measured. A test allows ten times
// that, at least kLeastBound: libraries round by processors, too. MODCAL_WRITE_DIGESTS=FILE writes
// them anew.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "experiments/study/study.hpp"
#include "libsim/base/instruction_set.hpp"
#include "tests/experiments/kinds/small_config.hpp"

namespace modcal::digests_test {
namespace {

constexpr double kLeastBound = 1e-9;

struct Quantity {
  std::string name;
  std::vector<double> values;
};

class Quantities {
 public:
  explicit Quantities(const StudyResult& result) {
    for (const FoundParameter& found : result.parameters) {
      add("parameter " + found.name, {found.value, found.deviation, found.initial});
    }
    for (const report::Block& block : result.blocks) {
      if (const auto* table = std::get_if<report::Table>(&block)) add(*table);
      if (const auto* figure = std::get_if<report::Figure>(&block)) add(*figure);
    }
    for (const SignalFile& file : result.signal_files) {
      for (const Signal& signal : file.signals) {
        add("signal " + file.name + '.' + signal.quantity, signal.samples);
      }
    }
  }
  const std::vector<Quantity>& all() const { return all_; }

 private:
  void add(std::string name, std::vector<double> values) {
    std::replace(name.begin(), name.end(), ' ', '_');
    if (!values.empty()) all_.push_back({std::move(name), std::move(values)});
  }
  void add(const report::Table& table) {
    for (std::size_t j = 0; j < table.columns.size(); ++j) {
      if (table.columns[j].key.find("seconds") != std::string::npos) continue;
      std::vector<double> values;
      for (const auto& row : table.rows) {
        if (const auto* number = std::get_if<double>(&row[j].value)) values.push_back(*number);
        if (const auto* count = std::get_if<std::int64_t>(&row[j].value)) {
          values.push_back(static_cast<double>(*count));
        }
      }
      add("table " + table.id + '.' + table.columns[j].key, std::move(values));
    }
  }
  void add(const report::Figure& figure) {
    for (std::size_t i = 0; i < figure.panels.size(); ++i) {
      const report::Panel& panel = figure.panels[i];
      for (std::size_t j = 0; j < panel.series.size(); ++j) {
        add(fmt::format("figure {}.{}.{}", figure.id, i + 1, j + 1), panel.series[j].y);
      }
      if (panel.map) {
        add(fmt::format("figure {}.{}.map", figure.id, i + 1),
            {panel.map->cells.begin(), panel.map->cells.end()});
      }
    }
  }

  std::vector<Quantity> all_;
};

std::vector<Quantity> quantities_of(const LoadedExperiment& loaded, std::size_t threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  SharedWork work;
  return Quantities(loaded.experiment->run(
                        {.work = work, .folder = loaded.document.folder(), .command = "test"}))
      .all();
}

/// "" or the first quantity that differs in a bit, with its place and values.
std::string first_difference(const std::vector<Quantity>& a, const std::vector<Quantity>& b) {
  if (a.size() != b.size()) return fmt::format("{} quantities, {}", a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::vector<double>&x = a[i].values, &y = b[i].values;
    if (a[i].name != b[i].name || x.size() != y.size()) {
      return fmt::format("{} of {} numbers, {} of {}", a[i].name, x.size(), b[i].name, y.size());
    }
    for (std::size_t k = 0; k < x.size(); ++k) {
      if (std::bit_cast<std::uint64_t>(x[k]) == std::bit_cast<std::uint64_t>(y[k])) continue;
      if (std::isnan(x[k]) && std::isnan(y[k])) continue;
      return fmt::format("{}[{}]: {}, {}", a[i].name, k, x[k], y[k]);
    }
  }
  return "";
}

struct Digest {
  std::size_t count = 0;  ///< of numbers that are finite
  double sum = 0.0;
  double scale = 0.0;
};

Digest digest_of(const std::vector<double>& values) {
  Digest digest;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    // Between 1/2 and 3/2, of no two places the same.
    const double weight = 0.5 + std::fmod(0.6180339887498949 * static_cast<double>(i + 1), 1.0);
    ++digest.count;
    digest.sum += weight * values[i];
    digest.scale += std::abs(values[i]);
  }
  return digest;
}

double difference(const Digest& a, const Digest& b) {
  if (a.count != b.count) return std::numeric_limits<double>::infinity();
  const double scale = std::max(a.scale, b.scale);
  return scale > 0.0 ? std::abs(a.sum - b.sum) / scale : 0.0;
}

struct Stored {
  double largest = 0.0;
  std::map<std::string, Digest> digests;
};

std::map<std::string, Stored> stored_digests() {
  std::map<std::string, Stored> stored;
  std::ifstream file(MODCAL_DIGESTS);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string config, quantity;
    Digest digest;
    if (!(words >> config >> quantity) || config == "#") continue;
    if (words >> digest.count >> digest.sum >> digest.scale) {
      stored[config].digests[quantity] = digest;
    } else {
      stored[config].largest = std::strtod(quantity.c_str(), nullptr);
    }
  }
  return stored;
}

std::string config_name(const std::string& file) {
  return std::filesystem::relative(file, MODCAL_CONFIGS).replace_extension().string();
}

void write(const std::string& config, const std::vector<Quantity>& quantities) {
  std::ofstream file(std::getenv("MODCAL_WRITE_DIGESTS"), std::ios::app);
  for (const Quantity& quantity : quantities) {
    const Digest digest = digest_of(quantity.values);
    file << fmt::format("{} {} {} {:.12g} {:.4g}\n", config, quantity.name, digest.count,
                        digest.sum, digest.scale);
  }
}

void expect_as_stored(const std::string& config, const std::vector<Quantity>& quantities) {
  static const std::map<std::string, Stored> all = stored_digests();
  const auto found = all.find(config);
  ASSERT_NE(found, all.end()) << config << ": no digests are stored";
  const Stored& stored = found->second;
  const double bound = std::max(kLeastBound, 10.0 * stored.largest);
  double largest = 0.0;
  std::string which, first;
  for (const Quantity& quantity : quantities) {
    const auto digest = stored.digests.find(quantity.name);
    ASSERT_NE(digest, stored.digests.end()) << config << ' ' << quantity.name << " is new";
    const double here = difference(digest_of(quantity.values), digest->second);
    if (here > bound && first.empty()) {
      first = fmt::format("{} is {:.3g} of its scale off, {:.3g} is allowed", quantity.name, here,
                          bound);
    }
    if (here > largest) which = quantity.name;
    largest = std::max(largest, here);
  }
  EXPECT_EQ(quantities.size(), stored.digests.size());
  EXPECT_EQ(first, "") << config << ": the first quantity that differs";
  std::printf("largest %s %.3g %s\n", config.c_str(), largest, which.c_str());
}

class Digests : public testing::TestWithParam<std::string> {};

TEST_P(Digests, AreThoseOfAnyThreadsAndInstructions) {
  const LoadedExperiment small = load_small(GetParam(), load_experiment(GetParam()));
  ASSERT_NE(small.experiment, nullptr);
  const std::vector<Quantity> one = quantities_of(small, 1);
  ASSERT_FALSE(one.empty());
  const std::string config = config_name(GetParam());
  if (std::getenv("MODCAL_WRITE_DIGESTS") != nullptr) return write(config, one);
  expect_as_stored(config, one);
  if (std::getenv("MODCAL_INSTRUCTIONS") != nullptr) return;  // threads are those of any set
  for (const std::size_t threads : {2, 8}) {
    EXPECT_EQ(first_difference(one, quantities_of(small, threads)), "")
        << config << " on " << threads << " threads: the first quantity that differs";
  }
}

INSTANTIATE_TEST_SUITE_P(All, Digests, testing::ValuesIn(config_files(MODCAL_CONFIGS)),
                         [](const testing::TestParamInfo<std::string>& parameter) {
                           std::string name = config_name(parameter.param);
                           std::replace(name.begin(), name.end(), '/', '_');
                           return name;
                         });

}  // namespace
}  // namespace modcal::digests_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const char* const wanted = std::getenv("MODCAL_INSTRUCTIONS");
  const std::vector<std::string> there = modcal::instruction_sets();
  if (wanted != nullptr && std::find(there.begin(), there.end(), wanted) == there.end()) {
    std::printf("this machine has no %s\n", wanted);
    return 77;  // ctest: skipped
  }
  modcal::limit_instructions_by_environment();
  return RUN_ALL_TESTS();
}
