#include "libcalib/objectives/posterior.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <optional>

#include "libcalib/parameters/stated_priors.hpp"
#include "libcalib/parameters/string_unknowns.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

/// A coordinate at x and its slopes.
struct Number {
  double value = 0.0;
  Eigen::VectorXd slope;
};

/// What is stated together, of one Gaussian.
struct Group {
  std::vector<ParameterName> names;
  bool about_law = false;  ///< ln f_n less that of the law
  Eigen::VectorXd mean;
  Eigen::MatrixXd root;  ///< L
};

class Posterior final : public ObjectiveFunction {
 public:
  Posterior(std::shared_ptr<const ObjectiveFunction> function, ParameterSet parameters)
      : function_(std::move(function)), parameters_(std::move(parameters)) {}

  /// What nothing of x moves is left out.
  void state(std::vector<ParameterName> names, const std::vector<double>& means,
             const Eigen::MatrixXd& covariance, bool about_law = false) {
    Group group{.names = {}, .about_law = about_law, .mean = {}, .root = {}};
    std::vector<Index> kept;
    std::vector<double> mean;
    const std::vector<double> x = parameters_.start();
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!number(names[i], x, parameters_.model(x))) continue;
      group.names.push_back(names[i]);
      mean.push_back(means[i]);
      kept.push_back(static_cast<Index>(i));
    }
    if (kept.empty()) return;
    group.mean = Eigen::Map<const Eigen::VectorXd>(mean.data(), static_cast<Index>(mean.size()));
    group.root = Eigen::MatrixXd(covariance(kept, kept)).llt().matrixL();
    rows_ += kept.size();
    groups_.push_back(std::move(group));
  }

  std::string_view name() const override { return function_->name(); }
  std::size_t dimension() const override { return function_->dimension(); }
  std::size_t residual_count() const override { return function_->residual_count() + rows_; }
  Capabilities capabilities() const override { return function_->capabilities(); }
  std::unique_ptr<const ObjectiveFunction> damped(double sigma) const override {
    auto result = std::make_unique<Posterior>(function_->damped(sigma), parameters_);
    result->groups_ = groups_;
    result->rows_ = rows_;
    return result;
  }
  StopReason follow_schedule(Evaluator& evaluator, const ScheduleOptions& options) const override {
    return function_->follow_schedule(evaluator, options);
  }

 private:
  std::optional<std::size_t> find(ParameterName name) const {
    for (const std::size_t record : {name.record, std::size_t{0}}) {
      name.record = record;
      for (std::size_t i = 0; i < parameters_.size(); ++i) {
        if (static_cast<const ParameterName&>(parameters_[i]) == name) return i;
      }
    }
    return std::nullopt;
  }

  // ln ζ_n or ln ω_n, by whatever moves it.
  std::optional<Number> of_mode(Moves what, std::size_t n, std::span<const double> x,
                                const ModelPoint& model) const {
    const bool damping = what == Moves::kDamping;
    const double at = damping ? model.basis.zeta[n] : model.basis.omega[n];
    Number number{std::log(at), Eigen::VectorXd::Zero(size())};
    bool moved = false;
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      const auto slopes =
          damping ? parameters_.damping_slopes(x, i) : parameters_.frequency_slopes(x, i);
      for (const FrequencySlope& one : slopes) {
        if (one.mode != n) continue;
        number.slope[static_cast<Index>(i)] += one.slope / at;
        moved = true;
      }
    }
    if (!moved) return std::nullopt;
    return number;
  }

  std::optional<Number> number(const ParameterName& name, std::span<const double> x,
                               const ModelPoint& model) const {
    const ParameterType& type = type_of(name);
    if (name.kind == ParameterKind::kDampingPower) {  // stated through ln ζ_2/ζ_1
      auto second = of_mode(Moves::kDamping, 1, x, model);
      const auto first = of_mode(Moves::kDamping, 0, x, model);
      if (!first || !second) return std::nullopt;
      return Number{second->value - first->value, second->slope - first->slope};
    }
    if (type.of_mode) {
      auto found = of_mode(type.moves, name.index, x, model);
      if (found && type.moves == Moves::kFrequencies) found->value -= std::log(type.per_unit);
      return found;
    }
    const std::optional<std::size_t> i = find(name);
    if (!i) return std::nullopt;
    Number result{type.coordinate(x[*i]), Eigen::VectorXd::Zero(size())};
    result.slope[static_cast<Index>(*i)] = 1.0 / type.slope(x[*i]);
    return result;
  }

  // Takes ln n f_0 √(1 + B n²) from ln f_n.
  void subtract_law(std::size_t mode, std::span<const double> x, Number& number) const {
    const auto f0 = *find({.kind = ParameterKind::kFundamental});
    const auto b = *find({.kind = ParameterKind::kInharmonicity});
    const double n = static_cast<double>(mode + 1);
    const double stiff = 1.0 + x[b] * n * n;
    number.value -= std::log(n * x[f0]) + 0.5 * std::log(stiff);
    number.slope[static_cast<Index>(f0)] -= 1.0 / x[f0];
    number.slope[static_cast<Index>(b)] -= 0.5 * n * n / stiff;
  }

  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    function_->evaluate(x, outputs);
    const ModelPoint model = parameters_.model(x);
    const bool slopes = outputs.gradient || outputs.jacobian || outputs.prior;
    std::size_t row = function_->residual_count();
    for (const Group& group : groups_) {
      const auto count = static_cast<Index>(group.names.size());
      Eigen::VectorXd apart = -group.mean;
      Eigen::MatrixXd slope(count, size());
      for (Index j = 0; j < count; ++j) {
        const ParameterName& name = group.names[static_cast<std::size_t>(j)];
        Number at = *number(name, x, model);
        if (group.about_law) subtract_law(name.index, x, at);
        apart[j] += at.value;
        if (slopes) slope.row(j) = at.slope;
      }
      const auto root = group.root.triangularView<Eigen::Lower>();
      root.solveInPlace(apart);
      if (slopes) root.solveInPlace(slope);
      add(apart, slope, row, outputs);
      row += group.names.size();
    }
  }

  void add(const Eigen::VectorXd& residuals, const Eigen::MatrixXd& slope, std::size_t row,
           const ObjectiveOutputs& outputs) const {
    using Vector = Eigen::Map<Eigen::VectorXd>;
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Index count = residuals.size();
    if (outputs.value) *outputs.value += 0.5 * residuals.squaredNorm();
    if (outputs.gradient) Vector(outputs.gradient, size()) += slope.transpose() * residuals;
    if (outputs.residuals) Vector(outputs.residuals + row, count) = residuals;
    if (outputs.prior) *outputs.prior += slope.transpose() * slope;
    if (!outputs.jacobian) return;
    Eigen::Map<Rows>(outputs.jacobian + row * dimension(), count, size()) = slope;
  }

  Index size() const { return static_cast<Index>(parameters_.size()); }

  std::shared_ptr<const ObjectiveFunction> function_;
  ParameterSet parameters_;
  std::vector<Group> groups_;
  std::size_t rows_ = 0;
};

// What the file states, with its correlations.
void state_entries(const UnknownsOptions& unknowns, const StatedPriors& stated,
                   Posterior& posterior) {
  std::vector<ParameterName> names;
  std::vector<double> means;
  Eigen::VectorXd deviations(static_cast<Index>(stated.entries().size()));
  for (const StatedPriors::Entry& entry : stated.entries()) {
    deviations[static_cast<Index>(names.size())] = entry.deviation;
    names.push_back(entry.name);
    means.push_back(entry.mean);
  }
  if (names.empty()) return;
  posterior.state(names, means,
                  deviations.asDiagonal() * prior_correlation(unknowns) * deviations.asDiagonal());
}

}  // namespace

std::unique_ptr<const ObjectiveFunction> with_priors(
    std::shared_ptr<const ObjectiveFunction> function, const Problem& problem,
    const ParameterSet& parameters, double law_width) {
  const ParameterOptions& options = problem.parameters;
  const StatedPriors stated(options.unknowns, problem.model, problem.records.size());
  auto posterior = std::make_unique<Posterior>(std::move(function), parameters);
  state_entries(options.unknowns, stated, *posterior);
  std::vector<ParameterName> ratios, frequencies;
  std::vector<std::size_t> modes;
  std::vector<double> means;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const ParameterName& name = parameters[i];
    if (name.kind == ParameterKind::kFrequency) frequencies.push_back(name);
    if (name.kind != ParameterKind::kDampingRatio || stated.has(name)) continue;
    ratios.push_back(name);
    modes.push_back(name.index);
    means.push_back(std::log(problem.model.basis.zeta[name.index]));
  }
  if (!ratios.empty()) {
    posterior->state(ratios, means, ratio_covariance(options.unknowns, modes));
  }
  const bool law =
      parameters.has(ParameterKind::kFundamental) && parameters.has(ParameterKind::kInharmonicity);
  if (!law || frequencies.empty()) return posterior;
  const double width = std::isnan(options.law_width) ? law_width : options.law_width;
  const auto count = static_cast<Index>(frequencies.size());
  posterior->state(frequencies, std::vector<double>(frequencies.size(), 0.0),
                   width * width * Eigen::MatrixXd::Identity(count, count), true);
  return posterior;
}

}  // namespace modcal
