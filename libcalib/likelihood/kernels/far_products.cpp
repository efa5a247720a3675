#include "libcalib/likelihood/kernels/far_products.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libcalib/likelihood/kernels/far_products.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libcalib/likelihood/kernels/mode_terms-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

constexpr std::size_t kRows = 2 * kNodes;  // real parts at the nodes, imaginary parts

// Columns at the nodes under conj(κ_q), q the parity of the decays: number `row` of column i stands
// at [row·stride + i].
struct NodeColumns {
  alignas(64) double numbers[2][kRows * kFarColumns];
};

// Columns in which near modes, the contact or a sensor have a share.
struct Exact {
  bool column[kFarColumns];

  Exact(const ModeSplit& split, const ColumnTask& task) {
    std::fill_n(column, task.count, true);
    for (const auto& list : split.far) {
      for (const std::size_t n : list) Mark(task, n, false);
    }
    for (const auto& list : split.near) {
      for (const std::size_t n : list) Mark(task, n, true);
    }
    if (task.contact < task.count) column[task.contact] = true;
  }
  void Mark(const ColumnTask& task, std::size_t n, bool exact) {
    for (std::size_t i = task.share_begin[n]; i < task.share_begin[n + 1]; ++i) {
      column[task.shares[i].column] = exact;
    }
  }
};

// Weights conj(κ_q) κ_p F and conj(κ_q) κ_p z^−1 of the nodes, four fields for every q and p.
void GatherWeights(const WhitenedRecord& record, std::size_t block_index,
                   const LikelihoodBlock& block, double* nodes) {
  alignas(64) double bins[16 * kBins];
  const Places places = BinsOf(record, block_index);
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const C factor[2] = {Load(block.odd, k), Load(block.even, k)};
    const C force = Load(block.force, k);
    const C delay = places.Delay(k);
    for (std::size_t q = 0; q < 2; ++q) {
      for (std::size_t p = 0; p < 2; ++p) {
        const C weight = ConjMul(factor[q], factor[p]);
        double* to = bins + 4 * (2 * q + p) * kBins + k;
        Store(Mul(weight, force), to, to + kBins);
        Store(Mul(weight, delay), to + 2 * kBins, to + 3 * kBins);
      }
    }
  }
  Gather(block_nodes(), bins, 16, nodes);
}

HWY_INLINE void AddToNodes(NodeColumns& columns, std::size_t q, std::size_t stride, std::size_t j,
                           std::size_t column, C z) {
  alignas(64) double re[kVectorPadding], im[kVectorPadding];
  Store(z, re, im);
  double* to = columns.numbers[q] + j * stride + column;
  for (std::size_t i = 0; i < hn::Lanes(D()); ++i) {
    to[i * stride] += re[i];
    to[(kNodes + i) * stride] += im[i];
  }
}

// What the far modes of one parity add to the columns that are theirs alone.
void AddFarColumns(const Places& places, const ModeSplit& split, std::size_t parity,
                   const ColumnTask& task, const Exact& exact, const double* weights,
                   std::size_t stride, NodeColumns& columns) {
  for (const std::size_t n : split.far[parity]) {
    for (std::size_t j = 0; j < kNodes; j += hn::Lanes(D())) {
      const ModeTerms terms = TermsOf(split.modes[n], n, task, places.BinsFrom(j), places.Delay(j));
      for (std::size_t i = task.share_begin[n]; i < task.share_begin[n + 1]; ++i) {
        const ColumnShare& share = task.shares[i];
        if (exact.column[share.column]) continue;
        C drive = AddScaled(Scale(terms.frequency.drive, Real(share.frequency)),
                            terms.damping.drive, Real(share.damping));
        if (share.residue != 0.0) {
          const double slope = share.residue * split.modes[n].residue_by_stiffness;
          drive = AddScaled(drive, terms.inverse, Real(slope));
        }
        const C decay = AddScaled(Scale(terms.frequency.decay, Real(share.frequency)),
                                  terms.damping.decay, Real(share.damping));
        for (std::size_t q = 0; q < 2; ++q) {
          const double* w = weights + 4 * (2 * q + parity) * kNodes + j;
          const C driven = Mul(Load(w, w + kNodes), drive);
          AddToNodes(columns, q, stride, j, share.column,
                     AddMul(driven, Load(w + 2 * kNodes, w + 3 * kNodes), decay));
        }
      }
    }
  }
}

// The other columns, from their numbers in the bins.
void AddExactColumn(const LikelihoodBlock& block, const double* column, std::size_t index,
                    std::size_t stride, NodeColumns& columns) {
  alignas(64) double bins[4 * kBins];
  alignas(64) double nodes[4 * kNodes];
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const C v = LoadColumn(column, k);
    Store(ConjMul(Load(block.odd, k), v), bins + k, bins + kBins + k);
    Store(ConjMul(Load(block.even, k), v), bins + 2 * kBins + k, bins + 3 * kBins + k);
  }
  Gather(block_nodes(), bins, 4, nodes);
  for (std::size_t q = 0; q < 2; ++q) {
    for (std::size_t row = 0; row < kRows; ++row) {
      columns.numbers[q][row * stride + index] = nodes[2 * q * kNodes + row];
    }
  }
}

// Rows of x_n and x'_n without κ: U + U' and i(U − U') at the nodes.
HWY_INLINE void FillDecayRows(const LikelihoodMode& mode, const Places& places, double* rows) {
  for (std::size_t j = 0; j < kNodes; j += hn::Lanes(D())) {
    const Decays decays = DecaysAt(mode.pole, places.Delay(j));
    const C difference = Sub(decays.u, decays.u_conj);
    Store(Add(decays.u, decays.u_conj), rows + j, rows + kNodes + j);
    Store(C{hn::Neg(difference.im), difference.re}, rows + kRows + j, rows + kRows + kNodes + j);
  }
}

// Adds the products of the rows of two modes with all columns to four rows of products.
HWY_INLINE void AddRows(const double* rows, const double* columns, std::size_t stride,
                        double* const* products) {
  for (std::size_t i = 0; i < stride; i += hn::Lanes(D())) {
    V a = LoadReal(products[0] + i), b = LoadReal(products[1] + i);
    V c = LoadReal(products[2] + i), d = LoadReal(products[3] + i);
    V e = hn::Zero(D()), f = e, g = e, h = e;  // two sums each hide the latency
    for (std::size_t r = 0; r < kRows; r += 2) {
      const V x = LoadReal(columns + r * stride + i);
      const V y = LoadReal(columns + (r + 1) * stride + i);
      a = hn::MulAdd(Real(rows[r]), x, a), e = hn::MulAdd(Real(rows[r + 1]), y, e);
      b = hn::MulAdd(Real(rows[kRows + r]), x, b), f = hn::MulAdd(Real(rows[kRows + r + 1]), y, f);
      c = hn::MulAdd(Real(rows[2 * kRows + r]), x, c);
      g = hn::MulAdd(Real(rows[2 * kRows + r + 1]), y, g);
      d = hn::MulAdd(Real(rows[3 * kRows + r]), x, d);
      h = hn::MulAdd(Real(rows[3 * kRows + r + 1]), y, h);
    }
    hn::Store(hn::Add(a, e), D(), products[0] + i), hn::Store(hn::Add(b, f), D(), products[1] + i);
    hn::Store(hn::Add(c, g), D(), products[2] + i), hn::Store(hn::Add(d, h), D(), products[3] + i);
  }
}

void AddFarProducts(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                    const LikelihoodBlock& block, const ColumnTask& task, double* products) {
  const Places places = NodesOf(record, block_index);
  const std::size_t stride = product_stride(task.count);
  NodeColumns columns;
  for (double* numbers : {columns.numbers[0], columns.numbers[1]}) {
    std::fill_n(numbers, kRows * stride, 0.0);
  }
  const Exact exact(split, task);
  alignas(64) double weights[16 * kNodes];
  GatherWeights(record, block_index, block, weights);
  for (std::size_t p = 0; p < 2; ++p) {
    AddFarColumns(places, split, p, task, exact, weights, stride, columns);
  }
  for (std::size_t i = 0; i < task.count; ++i) {
    if (!exact.column[i]) continue;
    AddExactColumn(block, task.jacobian + i * kColumnLength, i, stride, columns);
  }
  alignas(64) double spare[2 * kFarColumns];
  for (std::size_t q = 0; q < 2; ++q) {
    const std::span<const std::size_t> list = split.decaying(split.far[q]);
    for (std::size_t i = 0; i < list.size(); i += 2) {
      alignas(64) double rows[4 * kRows];
      double* to[4] = {nullptr, nullptr, spare, spare + kFarColumns};
      std::fill_n(spare, 2 * kFarColumns, 0.0);
      for (std::size_t m = 0; m < 2; ++m) {
        const bool there = i + m < list.size();
        const std::size_t n = list[there ? i + m : i];
        FillDecayRows(split.modes[n], places, rows + 2 * m * kRows);
        if (!there) continue;
        to[2 * m] = products + 2 * n * stride;
        to[2 * m + 1] = products + (2 * n + 1) * stride;
      }
      AddRows(rows, columns.numbers[q], stride, to);
    }
  }
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(AddFarProducts);

void add_far_products(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                      const LikelihoodBlock& block, const ColumnTask& task, double* products) {
  HWY_DYNAMIC_DISPATCH(AddFarProducts)(record, block_index, split, block, task, products);
}
}  // namespace modcal
#endif
