// Stability map of the simulators around the paper's case: for every time step and every value of
// one parameter at a time, whether the outcome is right, refused or reported. Writes the table to
// standard output and, for the figure, cells.txt and axes.gp to the folder named by the argument.
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/stress/stress_cell.hpp"
#include "libsim/base/task_loop.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/model/damping.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {
namespace {

struct Axis {
  std::string name, unit;
  std::vector<double> values;
  std::function<void(Scene&, double)> set;
};

// An axis of scenes that no number tells apart.
struct NamedAxis {
  std::string name;
  std::vector<NamedScene> (*scenes)(double duration);
};
const NamedAxis kNamedAxes[] = {{"bow and start", moving_bows}, {"contact", other_contacts}};

void set_stiffness(Scene& scene, double value) {
  CoulombExponential::Options options;
  options.adherence.stiffness = value;
  scene.friction = Choice<FrictionLaw>::of<CoulombExponential>("coulomb_exponential", options);
}

void set_damping(Scene& scene, double value) {
  scene.string.damping =
      Choice<DampingLaw>::of<ConstantDamping>("constant", ConstantDamping::Options{value});
}

std::vector<Axis> axes() {
  return {
      {"adherence stiffness", "N/m", {1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9}, set_stiffness},
      {"damping ratio", "1", {0.0, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.3, 0.5}, set_damping},
      {"modes",
       "1",
       {1, 2, 5, 20, 50, 200, 1000, 5000},
       [](Scene& s, double value) { s.string.modes = std::llround(value); }},
      {"bow position x_c/L",
       "1",
       {1e-6, 1e-4, 1e-2, 1.0 / 11.0, 0.1, 1.0 / 3.0, 0.4999, 0.5},
       [](Scene& s, double value) { s.bow.position = value * s.string.length; }},
      {"normal force",
       "N",
       {0.0, 1e-310, 1e-9, 1e-3, 1.0, 30.0, 1e3, 1e300},
       [](Scene& s, double value) { s.bow.normal_force = value; }},
      {"bow velocity",
       "m/s",
       {0.0, 1e-310, 1e-6, 1e-2, -0.1, 1.0, 10.0, 1e300},
       [](Scene& s, double value) { s.bow.velocity = value; }},
  };
}

constexpr std::array kSimulators = {"newmark_explicit", "modal_exact", "modal_event"};
constexpr std::array kSteps = {1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2};

struct Tally {
  std::array<int, 4> count{};
  double unbalanced = 0.0, allowed = 0.0;  // worst of the right cells
  int repeated = 0;   // right cells that keep their motion with a quarter of the step
  int no_digits = 0;  // that do not, nor with 1e-12 m/s more
};

void print_row(const std::string& axis, const char* simulator, const Tally& tally) {
  fmt::print("| {} | `{}` | {} | {} | {} | {} | {:.0e} | {:.0e} | ", axis, simulator,
             tally.count[0], tally.count[1], tally.count[2], tally.count[3], tally.unbalanced,
             tally.allowed);
  if (std::string_view(simulator) == "modal_event") {
    fmt::print("{} | {} |\n", tally.repeated, tally.no_digits);
  } else {
    fmt::print("– | – |\n");
  }
}

class Map {
 public:
  explicit Map(const std::string& folder)
      : cells_(fmt::output_file(folder + "/cells.txt")),
        axes_(fmt::output_file(folder + "/axes.gp")) {
    cells_.print(
        "# panel simulator step_index value_index outcome unbalanced allowed passivity "
        "distance sensitivity reason\n");
  }

  /// Cells are independent of each other: threads run them, the longest first.
  void run() {
    plan();
    std::atomic<std::size_t> done = 0;
    for_each_task(cells_todo_.size(), [&](std::size_t i) {
      Cell& cell = cells_todo_[i];
      cell.result = run_cell(cell.simulator, cell.scene, cell.step, cell.samples);
      if (++done % 100 == 0)
        fmt::print(stderr, "{} of {} cells\n", done.load(), cells_todo_.size());
    });
    print();
  }

  bool wrong() const { return wrong_; }

 private:
  struct Cell {
    std::size_t row;
    const char* simulator;
    Scene scene;
    double step;
    std::size_t samples;
    std::string place;  // panel, simulator, step and value in cells.txt; empty: in no panel
    CellResult result;
  };
  struct Row {
    std::string axis;
    const char* simulator;
    Tally tally;
  };

  void plan() {
    long_records();
    // Rows of the table end with the long records.
    std::vector<Row> last = std::exchange(rows_, {});
    const std::size_t long_cells = cells_todo_.size();
    int panel = 0;
    for (const Axis& axis : axes()) number_panel(axis, panel++);
    for (const NamedAxis& axis : kNamedAxes) named_panel(axis, panel++);
    for (std::size_t i = 0; i < long_cells; ++i) cells_todo_[i].row += rows_.size();
    std::ranges::move(last, std::back_inserter(rows_));
  }

  void print() {
    fmt::print(
        "| varied | simulator | right | refused | reported | wrong | balance open by | bound | "
        "repeat | no digits |\n|---|---|---|---|---|---|---|---|---|---|\n");
    for (const Cell& cell : cells_todo_) {
      const CellResult& result = cell.result;
      note(result, rows_[cell.row].tally);
      if (cell.place.empty()) continue;
      cells_.print("{} {} {:.1e} {:.1e} {:.2f} {:.1e} {:.1e} {}\n", cell.place,
                   static_cast<int>(result.outcome), result.unbalanced, result.allowed,
                   result.passivity, result.distance, result.sensitivity, result.reason);
    }
    for (const Row& row : rows_) print_row(row.axis, row.simulator, row.tally);
    fmt::print("\nReasons given:\n\n");
    for (const auto& [reason, count] : reasons_) fmt::print("- {} × {}\n", count, reason);
  }

  void number_panel(const Axis& axis, int panel) {
    std::vector<std::string> ticks;
    for (const double value : axis.values) ticks.push_back(fmt::format("{:.3g}", value));
    write_ticks(fmt::format("{} [{}]", axis.name, axis.unit), ticks, panel);
    for (const char* simulator : kSimulators) {
      rows_.push_back({axis.name, simulator, {}});
      for (std::size_t i = 0; i < kSteps.size(); ++i) {
        for (std::size_t j = 0; j < axis.values.size(); ++j) {
          Scene scene = paper_scene();
          axis.set(scene, axis.values[j]);
          add_cell(panel, i, j, scene, affordable_samples(scene, kSteps[i]));
        }
      }
    }
  }

  void named_panel(const NamedAxis& axis, int panel) {
    std::vector<std::string> ticks;
    for (const NamedScene& scene : axis.scenes(1.0)) ticks.push_back(scene.name);
    write_ticks(axis.name, ticks, panel);
    for (const char* simulator : kSimulators) {
      rows_.push_back({axis.name, simulator, {}});
      for (std::size_t i = 0; i < kSteps.size(); ++i) {
        const std::size_t samples = affordable_samples(paper_scene(), kSteps[i]);
        const auto scenes = axis.scenes(static_cast<double>(samples) * kSteps[i]);
        for (std::size_t j = 0; j < scenes.size(); ++j) {
          add_cell(panel, i, j, scenes[j].scene, samples);
        }
      }
    }
  }

  void add_cell(int panel, std::size_t i, std::size_t j, const Scene& scene, std::size_t samples) {
    const char* simulator = rows_.back().simulator;
    cells_todo_.push_back({rows_.size() - 1,
                           simulator,
                           scene,
                           kSteps[i],
                           samples,
                           fmt::format("{} {} {} {}", panel, simulator, i, j),
                           {}});
  }

  void write_ticks(const std::string& title, const std::vector<std::string>& ticks, int panel) {
    axes_.print("title_{} = '{}'\ntics_{} = '", panel, title, panel);
    for (std::size_t j = 0; j < ticks.size(); ++j) {
      axes_.print("{}\"{}\" {}", j > 0 ? ", " : "", ticks[j], j);
    }
    axes_.print("'\n");
  }

  void long_records() {
    constexpr std::size_t kSamples = 6'000'000;
    constexpr double kStep = 1e-5;
    for (const bool reverses : {false, true}) {
      for (const char* simulator : kSimulators) {
        Scene scene =
            reverses ? moving_bows(static_cast<double>(kSamples) * kStep)[1].scene : paper_scene();
        scene.string.modes = 10;
        rows_.push_back(
            {reverses ? "60 s of strokes, 10 modes, step 10 µs" : "60 s, 10 modes, step 10 µs",
             simulator,
             {}});
        cells_todo_.push_back({rows_.size() - 1, simulator, scene, kStep, kSamples, {}, {}});
      }
    }
  }

  void note(const CellResult& cell, Tally& tally) {
    ++tally.count[static_cast<std::size_t>(cell.outcome)];
    wrong_ = wrong_ || cell.outcome == Outcome::kWrong;
    if (cell.outcome == Outcome::kRight) {
      tally.unbalanced = std::max(tally.unbalanced, cell.unbalanced);
      tally.allowed = std::max(tally.allowed, cell.allowed);
      if (cell.distance <= kSameMotion) ++tally.repeated;
      if (cell.distance > kSameMotion) ++tally.no_digits;
    } else {
      ++reasons_[without_numbers(cell.reason)];
    }
  }

  static std::string without_numbers(const std::string& text) {
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
      const bool number =
          (text[i] >= '0' && text[i] <= '9') &&
          (i == 0 || text[i - 1] == ' ' || text[i - 1] == '-' || text[i - 1] == '(');
      if (!number) {
        result += text[i];
        continue;
      }
      result += '#';
      while (i + 1 < text.size() &&
             std::string("0123456789.e+-").find(text[i + 1]) != std::string::npos &&
             !(text[i + 1] == '.' && (i + 2 == text.size() || text[i + 2] == ' '))) {
        ++i;
      }
    }
    return result;
  }

  fmt::ostream cells_, axes_;
  std::vector<Cell> cells_todo_;
  std::vector<Row> rows_;
  std::map<std::string, int> reasons_;
  bool wrong_ = false;
};

}  // namespace
}  // namespace modcal

int main(int count, char** arguments) {
  modcal::Map map(count > 1 ? arguments[1] : ".");
  map.run();
  return map.wrong() ? 1 : 0;
}
