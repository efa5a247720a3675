// Where a mode rings in plucks.
#pragma once

#include <memory>
#include <span>

#include "libcalib/likelihood/pluck/pluck_likelihood.hpp"

namespace modcal {

/// Change of ln ω_n within ±0.6 % to where the plucks have most power about the mode; 0 where no
/// other place explains more of it than noise does.
double loudest_shift(std::span<const std::shared_ptr<const PluckLikelihood>> plucks,
                     const ModelPoint& model, std::size_t mode);

}  // namespace modcal
