#include "python/core/results.hpp"

#include <pybind11/stl.h>

#include "python/core/arrays.hpp"
#include "python/core/module.hpp"

namespace modcal::python {
namespace {

py::object cell_of(const report::Cell& cell) {
  return std::visit(
      [](const auto& value) -> py::object {
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::monostate>) {
          return py::none();
        } else {
          return py::cast(value);
        }
      },
      cell.value);
}

py::dict table_of(const report::Table& table) {
  py::dict units, columns;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    py::list cells;
    for (const auto& row : table.rows) cells.append(cell_of(row[i]));
    columns[py::str(table.columns[i].key)] = cells;
    units[py::str(table.columns[i].key)] = table.columns[i].unit;
  }
  py::dict described;
  described["title"] = table.title;
  described["caption"] = table.caption;
  described["units"] = units;
  described["columns"] = columns;
  return described;
}

py::dict axis_of(const report::Axis& axis) {
  py::dict described;
  described["text"] = axis.text();
  described["logarithmic"] = axis.logarithmic;
  described["range"] = axis.range ? py::cast(*axis.range) : py::none();
  return described;
}

py::dict series_of(const report::Series& series, const py::object& owner) {
  py::dict described;
  const bool points = series.style == report::SeriesStyle::kPoints;
  described["label"] = series.label;
  described["x"] = view_of(series.x, owner);
  described["y"] = view_of(series.y, owner);
  described["y_low"] = view_of(series.y_low, owner);
  described["y_high"] = view_of(series.y_high, owner);
  described["color"] = report::ink_of(series.color).light;
  described["line"] = !points;
  described["points"] = points || series.style == report::SeriesStyle::kLineWithPoints;
  described["dashed"] = series.style == report::SeriesStyle::kDashed;
  return described;
}

py::dict panel_of(const report::Panel& panel, const py::object& owner) {
  py::list series, markers;
  for (const report::Series* one : report::shown_series(panel))
    series.append(series_of(*one, owner));
  for (const report::Marker& marker : panel.markers) {
    py::dict described;
    described["vertical"] = marker.direction == report::Marker::Direction::kVertical;
    described["value"] = marker.value;
    described["label"] = marker.label;
    described["color"] = report::ink_of(marker.color).light;
    markers.append(described);
  }
  py::dict described;
  described["title"] = panel.title;
  described["x"] = axis_of(panel.x);
  described["y"] = axis_of(panel.y);
  described["series"] = series;
  described["markers"] = markers;
  return described;
}

py::dict figure_of(const report::Figure& figure, const py::object& owner) {
  py::list panels;
  for (const report::Panel& panel : figure.panels) panels.append(panel_of(panel, owner));
  py::dict described;
  described["title"] = figure.title;
  described["caption"] = figure.caption;
  described["columns"] = figure.columns;
  described["panels"] = panels;
  return described;
}

// The blocks of one type by their ids.
template <typename Block, typename Describe>
py::dict blocks_of(const Outcome& outcome, const Describe& describe) {
  py::dict described;
  for (const report::Block& block : outcome.result.blocks) {
    if (const auto* one = std::get_if<Block>(&block)) described[py::str(one->id)] = describe(*one);
  }
  return described;
}

// (text, whether it contradicts the result)
std::vector<std::pair<std::string, bool>> printed_warnings(const Outcome& outcome) {
  std::vector<std::pair<std::string, bool>> warnings;
  for (const report::Block& block : outcome.result.blocks) {
    const auto* text = std::get_if<report::Text>(&block);
    if (text == nullptr) continue;
    const bool failure = text->kind == report::Text::Kind::kFailure;
    if (failure || text->kind == report::Text::Kind::kWarning) {
      warnings.emplace_back(text->text, failure);
    }
  }
  return warnings;
}

// File, quantity, unit, sample rate, samples.
using SignalOfFile = std::tuple<std::string, std::string, std::string, double, py::array>;
std::vector<SignalOfFile> signals_of(const py::object& self) {
  std::vector<SignalOfFile> signals;
  for (const SignalFile& file : self.cast<const Outcome&>().result.signal_files) {
    for (const Signal& signal : file.signals) {
      signals.emplace_back(file.name, signal.quantity, signal.unit, signal.sample_rate,
                           view_of(signal.samples, self));
    }
  }
  return signals;
}

std::string_view status_of(const Outcome& outcome) {
  switch (outcome.result.status) {
    case report::Status::kOk:
      return "ok";
    case report::Status::kSomeFailed:
      return "some_failed";
    case report::Status::kFailed:
      break;
  }
  return "failed";
}

}  // namespace

void add_results(py::module_& module) {
  py::class_<Outcome, std::shared_ptr<Outcome>>(module, "Outcome")
      .def_property_readonly("summary", [](const Outcome& self) { return self.result.summary; })
      .def_property_readonly("answer", [](const Outcome& self) { return self.result.answer; })
      .def_property_readonly("status", &status_of)
      .def_property_readonly("seconds", [](const Outcome& self) { return self.seconds; })
      .def_property_readonly("missed", [](const Outcome& self) { return self.result.missed; })
      .def_property_readonly("failed_tasks",
                             [](const Outcome& self) { return self.result.failed_tasks; })
      .def_property_readonly("files",
                             [](const Outcome& self) {
                               py::dict files;
                               for (const auto& [name, content] : self.result.files)
                                 files[py::str(name)] = content;
                               return files;
                             })
      .def("warnings", &printed_warnings)
      .def("signals", &signals_of)
      .def("tables", [](const Outcome& self) { return blocks_of<report::Table>(self, &table_of); })
      .def("figures", [](const py::object& self) {
        return blocks_of<report::Figure>(
            self.cast<const Outcome&>(),
            [&self](const report::Figure& figure) { return figure_of(figure, self); });
      });
}

}  // namespace modcal::python
