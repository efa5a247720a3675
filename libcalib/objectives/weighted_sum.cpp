#include "libcalib/objectives/weighted_sum.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

struct BoundTerm {
  double weight = 1.0;
  std::unique_ptr<const ObjectiveFunction> function;
};

class SumScanner final : public CoordinateScanner {
 public:
  SumScanner(const std::vector<BoundTerm>& terms, std::span<const double> x) {
    for (const BoundTerm& term : terms) {
      weights_.push_back(term.weight);
      scanners_.push_back(term.function->scanner(x));
    }
  }
  void scan(std::size_t i, std::span<const double> candidates, std::span<double> values) override {
    std::fill(values.begin(), values.end(), 0.0);
    std::vector<double> part(values.size());
    for (std::size_t t = 0; t < scanners_.size(); ++t) {
      scanners_[t]->scan(i, candidates, part);
      for (std::size_t j = 0; j < part.size(); ++j) values[j] += weights_[t] * part[j];
    }
  }
  void move(std::size_t i, double value) override {
    for (const auto& scanner : scanners_) scanner->move(i, value);
  }
  bool reaches(std::size_t j, std::size_t i) const override {
    return std::any_of(scanners_.begin(), scanners_.end(),
                       [&](const auto& scanner) { return scanner->reaches(j, i); });
  }
  void refresh() override {
    for (const auto& scanner : scanners_) scanner->refresh();
  }

 private:
  std::vector<double> weights_;
  std::vector<std::unique_ptr<CoordinateScanner>> scanners_;
};

constexpr Capabilities kAll{.gradient = true, .least_squares = true, .residuals = true};

Capabilities common(const Capabilities& a, const Capabilities& b) {
  return {.gradient = a.gradient && b.gradient,
          .least_squares = a.least_squares && b.least_squares,
          .residuals = a.sum_of_squares() && b.sum_of_squares()};
}

class SumFunction final : public ObjectiveFunction {
 public:
  explicit SumFunction(std::vector<BoundTerm> terms) : terms_(std::move(terms)) {
    for (const BoundTerm& term : terms_) {
      capabilities_ = common(capabilities_, term.function->capabilities());
      residual_count_ += term.function->residual_count();
    }
    if (!capabilities_.sum_of_squares()) residual_count_ = 0;
  }
  std::string_view name() const override { return WeightedSum::kName; }
  std::size_t dimension() const override { return terms_.front().function->dimension(); }
  std::size_t residual_count() const override { return residual_count_; }
  Capabilities capabilities() const override { return capabilities_; }
  std::unique_ptr<CoordinateScanner> scanner(std::span<const double> x) const override {
    return std::make_unique<SumScanner>(terms_, x);
  }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const std::size_t n = dimension();
    if (outputs.value) *outputs.value = 0.0;
    if (outputs.gradient) std::fill_n(outputs.gradient, n, 0.0);
    std::vector<double> gradient(outputs.gradient ? n : 0);
    std::size_t row = 0;
    for (const auto& [weight, function] : terms_) {
      double value = 0.0;
      ObjectiveOutputs part{.value = &value,
                            .gradient = outputs.gradient ? gradient.data() : nullptr};
      if (outputs.residuals) part.residuals = outputs.residuals + row;
      if (outputs.jacobian) part.jacobian = outputs.jacobian + row * n;
      function->evaluate(x, part);
      const std::size_t m = function->residual_count();
      const double root = std::sqrt(weight);
      for (std::size_t j = 0; part.residuals && j < m; ++j) part.residuals[j] *= root;
      for (std::size_t j = 0; part.jacobian && j < m * n; ++j) part.jacobian[j] *= root;
      for (std::size_t i = 0; part.gradient && i < n; ++i) {
        outputs.gradient[i] += weight * gradient[i];
      }
      if (outputs.value) *outputs.value += weight * value;
      row += m;
    }
  }

  std::vector<BoundTerm> terms_;
  Capabilities capabilities_ = kAll;
  std::size_t residual_count_ = 0;
};

}  // namespace

void WeightedSum::Term::visit(OptionVisitor& visitor) {
  visitor("weight", "weight of the objective in the sum", {.range = Range::positive()}, weight);
  visitor("objective", "an objective of the sum", {.required = true}, objective);
}

void WeightedSum::Options::visit(OptionVisitor& visitor) {
  visitor("terms", "objectives and their weights", {.required = true}, terms);
}

WeightedSum::WeightedSum(const Options& options) : options_(options) {
  for (const Term& term : options_.terms) {
    MODCAL_REQUIRE(term.weight > 0.0 && std::isfinite(term.weight),
                   "weight {:g} of a term must be > 0", term.weight);
  }
}

Response WeightedSum::response(Moves what) const {
  MODCAL_REQUIRE(!options_.terms.empty(),
                 "a weighted_sum without terms: state terms: [{{weight: 1, objective: "
                 "joint_likelihood}}, ...]");
  Response response = Response::kNone;
  for (const Term& term : options_.terms) {
    const Response own = term.objective.make()->response(what);
    if (own == Response::kRefused) return own;
    if (own == Response::kMoves) response = own;
  }
  return response;
}

Capabilities WeightedSum::capabilities() const {
  Capabilities all = kAll;
  for (const Term& term : options_.terms) all = common(all, term.objective.make()->capabilities());
  return all;
}

bool WeightedSum::whitened() const {
  return std::all_of(options_.terms.begin(), options_.terms.end(), [](const Term& term) {
    return term.weight == 1.0 && term.objective.make()->whitened();
  });
}

void WeightedSum::require_record(const ModalBasis& basis, double sample_rate,
                                 std::size_t samples) const {
  for (const Term& term : options_.terms) {
    term.objective.make()->require_record(basis, sample_rate, samples);
  }
}

std::unique_ptr<const ObjectiveFunction> WeightedSum::do_bind(
    const CalibrationData& data, const ParameterSet& parameters) const {
  MODCAL_REQUIRE(!options_.terms.empty(), "a weighted_sum without terms: give at least one");
  std::vector<BoundTerm> bound;
  for (const Term& term : options_.terms) {
    bound.push_back({term.weight, term.objective.make()->bind_term(data, parameters)});
  }
  return std::make_unique<SumFunction>(std::move(bound));
}

}  // namespace modcal
