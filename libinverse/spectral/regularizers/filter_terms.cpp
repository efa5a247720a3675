#include "libinverse/spectral/regularizers/filter_terms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "libinverse/spectral/regularizers/tuning.hpp"

namespace modcal {
namespace {

using NodeValues = std::array<double, kFilterNodes>;

struct Band {
  double center = 0.0;
  double half_width = 0.0;
};

// Chebyshev moments Σ_i w_i T_p(t_i) of the three weights, t in [−1, 1] over the band.
struct Moments {
  NodeValues residual{};
  NodeValues solution{};
  NodeValues freedom{};

  void add(double t, double residual_i, double solution_i, double freedom_i) {
    double previous = t;  // T_{−1} = T_1
    double polynomial = 1.0;
    for (std::size_t p = 0; p < kFilterNodes; ++p) {
      residual[p] += polynomial * residual_i;
      solution[p] += polynomial * solution_i;
      freedom[p] += polynomial * freedom_i;
      const double next = 2.0 * t * polynomial - previous;
      previous = polynomial;
      polynomial = next;
    }
  }
};

double node(std::size_t j) {
  return std::cos(std::numbers::pi * (static_cast<double>(j) + 0.5) /
                  static_cast<double>(kFilterNodes));
}

// Weight of node j that gives every polynomial of degree < kFilterNodes the sum the components give
// it.
double node_weight(const NodeValues& moments, std::size_t j) {
  const double angle = std::numbers::pi * (static_cast<double>(j) + 0.5) / kFilterNodes;
  double sum = 0.5 * moments[0];
  for (std::size_t p = 1; p < kFilterNodes; ++p) {
    sum += moments[p] * std::cos(angle * static_cast<double>(p));
  }
  return sum * 2.0 / static_cast<double>(kFilterNodes);
}

void append_component(const SpectralSystem& system, std::size_t i, FilterTerms& terms) {
  terms.append(system.sigma[i], system.power[i], system.solution_weight[i] * system.power[i],
               system.multiplicity[i]);
}

void append_band(const SpectralSystem& system, std::size_t begin, std::size_t end,
                 FilterTerms& terms) {
  if (end - begin <= kFilterNodes) {
    for (std::size_t i = begin; i < end; ++i) append_component(system, i, terms);
    return;
  }
  const double high = system.sigma[begin];
  const double low = high / kFilterBandRatio;
  const Band band{.center = 0.5 * (high + low), .half_width = 0.5 * (high - low)};
  Moments moments;
  for (std::size_t i = begin; i < end; ++i) {
    moments.add((system.sigma[i] - band.center) / band.half_width, system.power[i],
                system.solution_weight[i] * system.power[i], system.multiplicity[i]);
  }
  for (std::size_t j = 0; j < kFilterNodes; ++j) {
    terms.append(band.center + band.half_width * node(j), node_weight(moments.residual, j),
                 node_weight(moments.solution, j), node_weight(moments.freedom, j));
  }
}

}  // namespace

void FilterTerms::append(double sigma_i, double residual_i, double solution_i, double freedom_i) {
  sigma.push_back(sigma_i);
  residual.push_back(residual_i);
  solution.push_back(solution_i);
  freedom.push_back(freedom_i);
}

FilterTerms terms_of(const SpectralSystem& system) {
  FilterTerms terms;
  terms.constant = system.outside_power;
  terms.sigma.assign(system.sigma.begin(), system.sigma.end());
  terms.residual.assign(system.power.begin(), system.power.end());
  terms.freedom.assign(system.multiplicity.begin(), system.multiplicity.end());
  terms.solution.resize(system.size());
  std::transform(system.power.begin(), system.power.end(), system.solution_weight.begin(),
                 terms.solution.begin(), std::multiplies<>());
  return terms;
}

FilterTerms compacted_terms_of(const SpectralSystem& system) {
  FilterTerms terms;
  terms.constant = system.outside_power;
  std::size_t begin = 0;
  while (begin < system.size() && system.sigma[begin] > 0.0) {
    const double low = system.sigma[begin] / kFilterBandRatio;
    std::size_t end = begin + 1;
    while (end < system.size() && system.sigma[end] >= low && system.sigma[end] > 0.0) ++end;
    append_band(system, begin, end, terms);
    begin = end;
  }
  for (std::size_t i = begin; i < system.size(); ++i) terms.constant += system.power[i];
  return terms;
}

void sum_filtered(const Regularizer& regularizer, const FilterTerms& terms,
                  std::span<const double> parameters, std::span<CurvePoint> curve) {
  std::vector<double> kept(terms.sigma.size());
  std::vector<double> lost(terms.sigma.size());
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    regularizer.filter_factors(terms.sigma, parameters[j], kept, lost);
    double residual = 0.0, solution = 0.0, freedom = 0.0;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      residual += lost[i] * lost[i] * terms.residual[i];
      solution += kept[i] * kept[i] * terms.solution[i];
      freedom += kept[i] * terms.freedom[i];
    }
    curve[j].residual_norm = terms.constant + residual;
    curve[j].solution_norm = solution;
    curve[j].freedom = freedom;
  }
}

}  // namespace modcal
