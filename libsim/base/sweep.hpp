// The cells of a sweep: copies of an experiment's options, each read with its own values.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace modcal {

class OptionVisitor;

/// One axis of a sweep: the dotted path of an option and the values it takes, as written.
struct SweepAxis {
  std::string path;
  std::vector<std::string> values;
};

/// Values of some options by their paths, as written.
using SweepPoint = std::vector<std::pair<std::string, std::string>>;

/// Which cells there are: every combination of the axes of `product` and of the groups of `zip`,
/// whose axes vary together, without the cells that agree with a point of `exclude`, then the
/// points of `include`. The last axis varies fastest.
struct SweepPlan {
  std::vector<SweepAxis> product;
  std::vector<std::vector<SweepAxis>> zip;
  std::vector<SweepPoint> exclude;
  std::vector<SweepPoint> include;
};

/// The values of every cell: `values[cell][i]` belongs to `paths[i]`; empty: the experiment's own.
struct SweepCells {
  std::vector<std::string> paths;
  std::vector<std::vector<std::string>> values;
};

/// The place of a sweep in a configuration.
class SweepSlot {
 public:
  virtual ~SweepSlot() = default;
  virtual const SweepPlan& plan() const = 0;
  /// Takes the plan and its cells and makes room for their options.
  virtual void set_cells(SweepPlan plan, SweepCells cells) = 0;
  virtual void visit_cell(std::size_t index, OptionVisitor& visitor) = 0;
};

}  // namespace modcal
