#include "benchmarks/nist/nist_problems.hpp"

#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "libsim/base/error.hpp"

namespace modcal {

constexpr std::size_t kMostParameters = 9;
using Jet = ceres::Jet<double, kMostParameters>;

/// f(x; b) as a number and with its derivatives.
struct NistModel {
  std::string_view name;
  double (*value)(const double* b, const double* x);
  Jet (*jet)(const Jet* b, const double* x);
};

namespace {

using std::atan, std::cos, std::exp, std::pow, std::sin;

// Generic in the type of b, so that one formula gives values and derivatives.
constexpr auto kSaturation = [](const auto* b, const double* x) {
  return b[0] * (1.0 - exp(-b[1] * x[0]));
};
constexpr auto kMisra1b = [](const auto* b, const double* x) {
  const auto root = 1.0 + 0.5 * b[1] * x[0];
  return b[0] * (1.0 - 1.0 / (root * root));
};
constexpr auto kMisra1c = [](const auto* b, const double* x) {
  return b[0] * (1.0 - pow(1.0 + 2.0 * b[1] * x[0], -0.5));
};
constexpr auto kMisra1d = [](const auto* b, const double* x) {
  return b[0] * b[1] * x[0] / (1.0 + b[1] * x[0]);
};
constexpr auto kChwirut = [](const auto* b, const double* x) {
  return exp(-b[0] * x[0]) / (b[1] + b[2] * x[0]);
};
constexpr auto kLanczos = [](const auto* b, const double* x) {
  return b[0] * exp(-b[1] * x[0]) + b[2] * exp(-b[3] * x[0]) + b[4] * exp(-b[5] * x[0]);
};
constexpr auto kGauss = [](const auto* b, const double* x) {
  const auto u = (x[0] - b[3]) / b[4];
  const auto v = (x[0] - b[6]) / b[7];
  return b[0] * exp(-b[1] * x[0]) + b[2] * exp(-u * u) + b[5] * exp(-v * v);
};
constexpr auto kDanWood = [](const auto* b, const double* x) { return b[0] * pow(x[0], b[1]); };
constexpr auto kKirby2 = [](const auto* b, const double* x) {
  return (b[0] + x[0] * (b[1] + x[0] * b[2])) / (1.0 + x[0] * (b[3] + x[0] * b[4]));
};
constexpr auto kCubics = [](const auto* b, const double* x) {
  return (b[0] + x[0] * (b[1] + x[0] * (b[2] + x[0] * b[3]))) /
         (1.0 + x[0] * (b[4] + x[0] * (b[5] + x[0] * b[6])));
};
// Of the logarithm of y.
constexpr auto kNelson = [](const auto* b, const double* x) {
  return b[0] - b[1] * x[0] * exp(-b[2] * x[1]);
};
constexpr auto kMgh17 = [](const auto* b, const double* x) {
  return b[0] + b[1] * exp(-x[0] * b[3]) + b[2] * exp(-x[0] * b[4]);
};
constexpr auto kRoszman1 = [](const auto* b, const double* x) {
  return b[0] - b[1] * x[0] - atan(b[2] / (x[0] - b[3])) * std::numbers::inv_pi;
};
constexpr auto kEnso = [](const auto* b, const double* x) {
  const double turn = 2.0 * std::numbers::pi * x[0];
  return b[0] + b[1] * cos(turn / 12.0) + b[2] * sin(turn / 12.0) + b[4] * cos(turn / b[3]) +
         b[5] * sin(turn / b[3]) + b[7] * cos(turn / b[6]) + b[8] * sin(turn / b[6]);
};
constexpr auto kMgh09 = [](const auto* b, const double* x) {
  return b[0] * x[0] * (x[0] + b[1]) / (x[0] * (x[0] + b[2]) + b[3]);
};
constexpr auto kRat42 = [](const auto* b, const double* x) {
  return b[0] / (1.0 + exp(b[1] - b[2] * x[0]));
};
constexpr auto kMgh10 = [](const auto* b, const double* x) {
  return b[0] * exp(b[1] / (x[0] + b[2]));
};
constexpr auto kEckerle4 = [](const auto* b, const double* x) {
  const auto u = (x[0] - b[2]) / b[1];
  return b[0] / b[1] * exp(-0.5 * u * u);
};
constexpr auto kRat43 = [](const auto* b, const double* x) {
  return b[0] * pow(1.0 + exp(b[1] - b[2] * x[0]), -1.0 / b[3]);
};
constexpr auto kBennett5 = [](const auto* b, const double* x) {
  return b[0] * pow(b[1] + x[0], -1.0 / b[2]);
};

constexpr std::array<NistModel, 27> kModels = {{
    {"Misra1a", kSaturation, kSaturation},
    {"Chwirut2", kChwirut, kChwirut},
    {"Chwirut1", kChwirut, kChwirut},
    {"Lanczos3", kLanczos, kLanczos},
    {"Gauss1", kGauss, kGauss},
    {"Gauss2", kGauss, kGauss},
    {"DanWood", kDanWood, kDanWood},
    {"Misra1b", kMisra1b, kMisra1b},
    {"Kirby2", kKirby2, kKirby2},
    {"Hahn1", kCubics, kCubics},
    {"Nelson", kNelson, kNelson},
    {"MGH17", kMgh17, kMgh17},
    {"Lanczos1", kLanczos, kLanczos},
    {"Lanczos2", kLanczos, kLanczos},
    {"Gauss3", kGauss, kGauss},
    {"Misra1c", kMisra1c, kMisra1c},
    {"Misra1d", kMisra1d, kMisra1d},
    {"Roszman1", kRoszman1, kRoszman1},
    {"ENSO", kEnso, kEnso},
    {"MGH09", kMgh09, kMgh09},
    {"Thurber", kCubics, kCubics},
    {"BoxBOD", kSaturation, kSaturation},
    {"Rat42", kRat42, kRat42},
    {"MGH10", kMgh10, kMgh10},
    {"Eckerle4", kEckerle4, kEckerle4},
    {"Rat43", kRat43, kRat43},
    {"Bennett5", kBennett5, kBennett5},
}};

constexpr auto kNames = [] {
  std::array<std::string_view, kModels.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kModels[i].name;
  return names;
}();

std::vector<double> numbers_of(std::istream& words) {
  std::vector<double> numbers;
  for (double number = 0.0; words >> number;) numbers.push_back(number);
  return numbers;
}

}  // namespace

std::span<const std::string_view> nist_names() { return kNames; }

NistProblem::NistProblem(const std::string& folder, std::string_view name) : name_(name) {
  model_ = std::find_if(kModels.begin(), kModels.end(),
                        [&](const NistModel& model) { return model.name == name; });
  MODCAL_REQUIRE(model_ != kModels.end(), "NIST has no problem \"{}\"", name);
  const std::string path = folder + "/" + name_ + ".txt";
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    if (y_.empty() && !std::isdigit(line.back())) continue;  // the comment, the names of columns
    std::string key;
    if (std::isalpha(line.front())) words >> key;
    std::vector<double> numbers = numbers_of(words);
    if (key == "start1") starts_[0] = numbers;
    if (key == "start2") starts_[1] = numbers;
    if (key == "certified") certified_ = numbers;
    if (key == "sum_of_squares") sum_of_squares_ = numbers.at(0);
    if (!key.empty()) continue;
    predictors_ = numbers.size() - 1;
    y_.push_back(name == "Nelson" ? std::log(numbers.at(0)) : numbers.at(0));
    x_.insert(x_.end(), numbers.begin() + 1, numbers.end());
  }
  MODCAL_REQUIRE(!y_.empty() && starts_[0].size() == certified_.size() && !certified_.empty(),
                 "{} cannot be read as a problem of NIST", path);
}

std::vector<Variable> NistProblem::variables(int start) const {
  std::vector<Variable> variables;
  for (const double at : starts_[start - 1]) {
    const double size = std::abs(at);
    const std::string label = "b" + std::to_string(variables.size() + 1);
    variables.push_back({label, "1", at, at - 1000.0 * size, at + 1000.0 * size, size});
  }
  return variables;
}

double NistProblem::digits(std::span<const double> b) const {
  double digits = 11.0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    digits =
        std::min(digits, -std::log10(std::abs(b[i] - certified_[i]) / std::abs(certified_[i])));
  }
  return std::max(0.0, digits);
}

void NistProblem::do_evaluate(std::span<const double> b, const ObjectiveOutputs& outputs) const {
  const std::size_t n = dimension();
  const bool slopes = outputs.gradient || outputs.jacobian;
  std::array<Jet, kMostParameters> jets;
  for (std::size_t i = 0; i < n; ++i) jets[i] = Jet(b[i], static_cast<int>(i));
  double value = 0.0;
  if (outputs.gradient) std::fill_n(outputs.gradient, n, 0.0);
  for (std::size_t j = 0; j < y_.size(); ++j) {
    const double* x = &x_[predictors_ * j];
    const Jet f = slopes ? model_->jet(jets.data(), x) : Jet(model_->value(b.data(), x));
    const double residual = f.a - y_[j];
    value += 0.5 * residual * residual;
    if (outputs.residuals) outputs.residuals[j] = residual;
    for (std::size_t i = 0; slopes && i < n; ++i) {
      const double slope = f.v[static_cast<int>(i)];
      if (outputs.jacobian) outputs.jacobian[n * j + i] = slope;
      if (outputs.gradient) outputs.gradient[i] += slope * residual;
    }
  }
  if (outputs.value) *outputs.value = value;
}

}  // namespace modcal
