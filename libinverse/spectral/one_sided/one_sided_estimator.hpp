#pragma once

#include "libinverse/estimator.hpp"

namespace modcal {

/// Each reaction gives a force of its own (Debut, Delaune and Antunes, 2010, section 4), with the
/// regularizer and the parameter choice of the method.
class OneSidedEstimator final : public Estimator {
 public:
  struct Options {
    void visit(OptionVisitor& /*visitor*/) {}
  };
  explicit OneSidedEstimator(const Options& /*options*/) {}

 private:
  std::shared_ptr<const PreparedEstimator> do_prepare(const EstimationModel& model) const override;
};

}  // namespace modcal
