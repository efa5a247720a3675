// All records of one string as one likelihood.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "libcalib/likelihood/projected_likelihood.hpp"
#include "libcalib/likelihood/record_likelihood.hpp"
#include "libcalib/parameters/string_unknowns.hpp"

namespace modcal {

/// A stroke: bins weighted in the fit, all alike in χ².
class StrokeLikelihood final : public RecordLikelihood {
 public:
  StrokeLikelihood(ProjectedLikelihood whole, ProjectedLikelihood weighted)
      : whole_(std::move(whole)), weighted_(std::move(weighted)) {}
  LikelihoodPoint evaluate(const ModelPoint& point, const LikelihoodColumns& columns,
                           const LikelihoodOutputs& outputs) const override {
    return weighted_.evaluate(point, columns, outputs);
  }
  LikelihoodPoint slope(const ModelPoint& point, const LikelihoodColumns& columns) const override {
    return weighted_.slope(point, columns);
  }
  std::size_t residual_count() const override { return 2 * weighted_.record().bins + 1; }
  Eigen::MatrixXd noise_information(const ModelPoint& point,
                                    const LikelihoodColumns& columns) const override;
  LikelihoodPoint unweighted(const ModelPoint& point,
                             const LikelihoodColumns& columns) const override;
  double degrees_of_freedom(const ModelPoint& point) const override;

 private:
  ProjectedLikelihood whole_, weighted_;
};

/// Unknowns of the first record, then what each further record has for itself. Records are
/// independent: costs, slopes and informations add.
class AllRecords {
 public:
  using Index = Eigen::Index;

  explicit AllRecords(const StringUnknowns& shared) : unknowns_(shared), size_(shared.size()) {}

  /// held_contact: x_c where it is known exactly [m]. start: θ of the record; own: which of it no
  /// other record has, ascending. The first record owns nothing, all it has is shared. A record of
  /// which only the places are asked may be null.
  void add(std::shared_ptr<const RecordLikelihood> record, const Eigen::VectorXd& start,
           const std::vector<Index>& own, std::optional<double> held_contact = {});

  Index size() const { return size_; }
  /// Whether an unknown of a record keeps its start exactly.
  bool held(Index i, std::size_t record) const { return unknowns_.held(i, record); }
  void hold(PriorEquations& equations) const;
  /// Zero where an unknown is held.
  void clear_held(Eigen::MatrixXd& covariance) const;
  std::size_t records() const { return records_.size(); }
  const StringUnknowns& unknowns() const { return unknowns_; }
  const Eigen::VectorXd& start() const { return start_; }
  /// Place of unknown i of a record among all.
  Index place(Index i, std::size_t record) const {
    return places_[record][static_cast<std::size_t>(i)];
  }
  /// θ of one record.
  Eigen::VectorXd own(const Eigen::VectorXd& theta, std::size_t record) const;
  ModelPoint model(const Eigen::VectorXd& theta, std::size_t record) const;
  bool admits(const Eigen::VectorXd& theta) const;
  /// Coordinate of a prior, see StringUnknowns.
  std::optional<LinearForm> coordinate(const ParameterName& name,
                                       const Eigen::VectorXd& theta) const;
  LikelihoodPoint evaluate(const Eigen::VectorXd& theta, bool twice_weighted) const;
  LikelihoodPoint unweighted(const Eigen::VectorXd& theta) const;
  Eigen::MatrixXd noise(const Eigen::VectorXd& theta) const;

  struct Misfit {
    double chi2 = 0.0;       ///< reduced
    double deviation = 0.0;  ///< its standard deviation
  };
  /// cost: without weights at θ; noise_errors: relative standard deviation of the noise power
  /// stated for each record; taken: residuals that the fit takes.
  Misfit misfit(const Eigen::VectorXd& theta, double cost, std::span<const double> noise_errors,
                double taken) const;

 private:
  std::vector<Index> held_places() const;
  template <typename EvaluateRecord>
  LikelihoodPoint sum_of(const Eigen::VectorXd& theta, EvaluateRecord evaluate_record) const;
  void add_to(Eigen::MatrixXd& sum, const Eigen::MatrixXd& part, std::size_t record) const;

  StringUnknowns unknowns_;
  Index size_;
  Eigen::VectorXd start_;
  std::vector<std::shared_ptr<const RecordLikelihood>> records_;
  std::vector<std::vector<Index>> places_;
  std::vector<std::optional<double>> held_contacts_;
};

}  // namespace modcal
