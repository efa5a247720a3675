// What the error bars of a calibration hold, on a record of the independent string.
//
//     error_bars RECORD NOISE [MODES]
//
// RECORD.csv and RECORD.json are those of `truth`. For f0, B, x_c and the median f_n: the deviation
// printed over the bound that includes the stated mismatch (gain, delay, corner, response, scatter
// of the damping), over the bound of exact sensors and stated damping, and the parts of its
// variance that a bridge, a second polarization and causes suspected add.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libcalib/calibration.hpp"
#include "libcalib/identifiability/expected_limit.hpp"
#include "libsim/base/random.hpp"
#include "libsim/model/damping.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

struct Record {
  std::array<std::vector<double>, 2> reactions;
  double rate = 0.0, contact = 0.0;
  StringModel string;
};

Record read(const std::string& path, std::int64_t modes) {
  std::ifstream file(path + ".json"), table(path + ".csv");
  const auto truth = nlohmann::json::parse(file);
  const auto& string = truth["string"];
  Record record{.rate = truth["record"]["rate"], .contact = truth["x_c"]};
  TableDamping::Options damping;
  for (const double f : truth["modes"]["f"]) damping.frequencies.push_back(f);
  for (const double zeta : truth["modes"]["zeta"]) damping.ratios.push_back(zeta);
  record.string = {.length = string["L"],
                   .linear_density = string["rho_L"],
                   .fundamental = string["f0"],
                   .inharmonicity = string["B"],
                   .modes = modes,
                   .damping = Choice<DampingLaw>::of<TableDamping>("table", std::move(damping))};
  std::string line;
  std::getline(table, line);
  while (std::getline(table, line)) {
    std::istringstream cells(line);
    std::string time, left, right;
    std::getline(std::getline(std::getline(cells, time, ','), left, ','), right, ',');
    record.reactions[0].push_back(std::stod(left));
    record.reactions[1].push_back(std::stod(right));
  }
  return record;
}

NoisyRecords with_noise(const Record& record, double level, bool noisy) {
  NoisyRecords records{.reactions = record.reactions, .sample_rate = record.rate};
  std::vector<double> normal(records.samples());
  for (std::size_t r = 0; r < 2; ++r) {
    remove_mean(records.reactions[r]);
    records.deviation[r] = level * standard_deviation(records.reactions[r]);
    fill_standard_normal(StreamKey(7).with(std::uint64_t{r}), normal);
    for (std::size_t j = 0; noisy && j < normal.size(); ++j) {
      records.reactions[r][j] += records.deviation[r] * normal[j];
    }
  }
  return records;
}

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::nth_element(values.begin(), values.begin() + std::ssize(values) / 2, values.end());
  return values[values.size() / 2];
}

ExpectedLimit bound(const BoundProblem& bound, const NoisyRecords& clean, double width,
                    bool exact) {
  LimitCase question{.truth = bound.parameters.initial(),
                     .strokes = {clean},
                     .contacts = {bound.parameters.initial().contact},
                     .plucks = {},
                     .law_width = width,
                     .unknowns = exact ? UnknownsOptions() : bound.problem.parameters.unknowns};
  if (exact) question.unknowns.damping = "fixed";
  return expected_limit(question);
}

struct Row {
  std::string name;
  double printed, stated, exact, bridge, polarization, suspected;
};

void print(const Row& row) {
  const double variance = row.printed * row.printed;
  fmt::print(
      "{:4} sd {:8.2e}  over the bound with the mismatch stated {:5.2f}, exact {:6.2f}; of its "
      "variance bridge {:4.1f} %, polarization {:4.1f} %, suspected {:4.1f} %\n",
      row.name, row.printed, row.printed / row.stated, row.printed / row.exact,
      100.0 * row.bridge / variance, 100.0 * row.polarization / variance,
      100.0 * row.suspected / variance);
}

void run(const std::string& path, double level, std::int64_t modes) {
  const Record record = read(path, modes);
  const NoisyRecords noisy = with_noise(record, level, true);
  CalibrationOptions options = calibration_to_the_bound();
  options.parameters.unknowns.damping = "auto";
  const ModelPoint truth{make_modal_basis(record.string), record.contact};
  const std::vector<CalibrationRecord> records = {
      {.data = CalibrationData::of_records(noisy.reactions[0], noisy.reactions[1], record.rate),
       .recorded = true}};
  const CalibrationResult result = calibrate(truth, records, options);
  const ContinuationResult& fit = *result.continuation;
  const BoundProblem problem = bind(options.problem(truth, records), *options.optimizer.make());
  const NoisyRecords clean = with_noise(record, level, false);
  const ExpectedLimit stated = bound(problem, clean, fit.law_width, false);
  const ExpectedLimit exact = bound(problem, clean, fit.law_width, true);
  // Variances that the causes add, of every unknown: f_n, then x_c.
  Eigen::VectorXd bridge = Eigen::VectorXd::Zero(modes + 1), polarization = bridge,
                  suspected = bridge;
  for (const ScoreTest& test : fit.tests) {
    suspected += test.suspected().head(modes + 1).cwiseAbs2();
    if (test.untold.size() == 0) continue;
    (test.cause == kBridge ? bridge : polarization) += test.untold.diagonal().head(modes + 1);
  }
  fmt::print("{}, noise {:g} %: chi2 {:.4f}, tau {:.1e}, {}\n", path, 100.0 * level, fit.chi2,
             fit.law_width, fit.right ? "accepted" : "refused");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  print({"f0", fit.found_law.deviation[0], stated.find("f0")->law, exact.find("f0")->law, nan, nan,
         nan});
  print({"B", fit.found_law.deviation[1], stated.find("B")->law, exact.find("B")->law, nan, nan,
         nan});
  print({"x_c", fit.contact_deviation, stated.contact, exact.contact, bridge[modes],
         polarization[modes], suspected[modes]});
  std::vector<double> over_stated, over_exact, by_bridge, by_polarization, by_suspected, printed;
  for (std::size_t n = 0; n < fit.modes.size(); ++n) {
    if (fit.modes[n].source != ModeSource::kIdentified) continue;
    const auto i = static_cast<Eigen::Index>(n);
    const double sd = fit.modes[n].deviation;
    printed.push_back(sd);
    over_stated.push_back(sd / stated.modes[n].deviation);
    over_exact.push_back(sd / exact.modes[n].deviation);
    by_bridge.push_back(bridge[i] / (sd * sd));
    by_polarization.push_back(polarization[i] / (sd * sd));
    by_suspected.push_back(suspected[i] / (sd * sd));
  }
  const double sd = median(printed);
  print({"f_n", sd, sd / median(over_stated), sd / median(over_exact), sd * sd * median(by_bridge),
         sd * sd * median(by_polarization), sd * sd * median(by_suspected)});
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "error_bars RECORD NOISE [MODES]\n");
    return 1;
  }
  modcal::run(argv[1], std::atof(argv[2]), argc > 3 ? std::atoll(argv[3]) : 40);
  return 0;
}
