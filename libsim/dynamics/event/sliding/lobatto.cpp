#include "libsim/dynamics/event/sliding/lobatto.hpp"

#include "libsim/base/error.hpp"

namespace modcal::event {
namespace {

LobattoRule::Row lobatto_nodes(int nodes) {
  switch (nodes) {
    case 2:
      return {0.0, 1.0};
    case 3:
      return {0.0, 0.5, 1.0};
    case 4:
      return {0.0, 0.5 * (1.0 - std::sqrt(0.2)), 0.5 * (1.0 + std::sqrt(0.2)), 1.0};
    default:
      return {0.0, 0.5 * (1.0 - std::sqrt(3.0 / 7.0)), 0.5, 0.5 * (1.0 + std::sqrt(3.0 / 7.0)),
              1.0};
  }
}

double binomial(int n, int k) {
  double value = 1.0;
  for (int i = 1; i <= k; ++i) value *= static_cast<double>(n - k + i) / i;
  return value;
}

void fill_lagrange(LobattoRule& rule) {
  for (int j = 0; j < rule.nodes; ++j) {
    LobattoRule::Row product{1.0};
    for (int i = 0; i < rule.nodes; ++i) {
      if (i == j) continue;
      const double scale = 1.0 / (rule.node[j] - rule.node[i]);
      for (int k = rule.nodes - 1; k >= 0; --k) {
        product[k] = scale * ((k > 0 ? product[k - 1] : 0.0) - rule.node[i] * product[k]);
      }
    }
    rule.power[j] = product;
  }
}

void fill_bernstein(LobattoRule& rule) {
  const int degree = rule.nodes - 1;
  for (int i = 0; i <= degree; ++i) {
    for (int j = 0; j <= degree; ++j) {
      double sum = 0.0;
      for (int k = 0; k <= i; ++k) sum += binomial(i, k) / binomial(degree, k) * rule.power[j][k];
      rule.bernstein[i][j] = sum;
    }
  }
}

// Largest |Π (θ − c_i)| from a fine scan; between scan points it exceeds them by less than 1e-3.
double largest_node_product(const LobattoRule& rule) {
  double largest = 0.0;
  for (int n = 0; n <= 400; ++n) {
    double product = 1.0;
    for (int i = 0; i < rule.nodes; ++i) product *= n / 400.0 - rule.node[i];
    largest = std::max(largest, std::abs(product));
  }
  return 1.001 * largest;
}

}  // namespace

double LobattoRule::power_remainder(int m) const {
  double factor = m >= nodes ? remainder : 0.0;
  for (int i = 0; i < nodes; ++i) factor *= m - i;
  return factor;
}

LobattoRule lobatto_rule(int nodes) {
  MODCAL_REQUIRE(nodes >= 2 && nodes <= kMaxNodes,
                 "{} collocation nodes: there are rules of 2 to 5", nodes);
  LobattoRule rule;
  rule.nodes = nodes;
  rule.node = lobatto_nodes(nodes);
  fill_lagrange(rule);
  fill_bernstein(rule);
  rule.remainder = largest_node_product(rule) / std::tgamma(nodes + 1.0);
  return rule;
}

}  // namespace modcal::event
