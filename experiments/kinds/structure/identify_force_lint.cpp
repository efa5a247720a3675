// What is wrong with an experiment of kind "identify_force" before it runs.
#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/kinds/lint.hpp"
#include "experiments/kinds/structure/structure_kinds.hpp"
#include "libinverse/structure/tuning.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// Tables of one list of files, each of another place.
void lint_named_once(const std::string& key, const std::string& table,
                     const std::vector<std::string>& others, std::vector<Finding>& findings) {
  std::vector<std::filesystem::path> before = {std::filesystem::path(table).lexically_normal()};
  for (std::size_t i = 0; i < others.size(); ++i) {
    const auto path = std::filesystem::path(others[i]).lexically_normal();
    if (std::ranges::find(before, path) != before.end()) {
      add_finding(findings, fmt::format("{}.{}", key, i),
                  "{} is named twice: each contact has a table of its own", others[i]);
    }
    before.push_back(path);
  }
}

}  // namespace

std::vector<Finding> IdentifyForceOptions::lint() const {
  std::vector<Finding> findings = lint_responses("record.responses", record.responses.size());
  if (!other_places.empty() && record.responses.size() == 1) {
    add_finding(findings, "other_places",
                "one response is explained by a force at any place: name a second sensor, or leave "
                "the other places out");
  }
  lint_named_once("other_places", table, other_places, findings);
  lint_named_once("other_contacts", table, other_contacts, findings);
  if (contour * window > kLongestWeighted) {
    add_finding(
        findings, "contour",
        "{:g} 1/s leaves exp(-{:.3g}) of the record at the end of a window of {:g} s: state "
        "a window of {:.3g} s or less, or a contour of {:.3g} 1/s or less",
        contour, contour * window, window, kLongestWeighted / contour, kLongestWeighted / window);
  }
  if (!other_contacts.empty()) {
    const std::size_t contacts = 1 + other_contacts.size(), sensors = record.responses.size();
    if (sensors <= contacts) {
      add_finding(findings, "other_contacts",
                  "{} responses are explained by forces at {} contacts whatever they are: name {} "
                  "sensors or more, or fewer contacts",
                  sensors, contacts, contacts + 1);
    }
    if (!other_places.empty()) {
      add_finding(findings, "other_places",
                  "a place is looked for of one force alone: leave other_places or other_contacts "
                  "out");
    }
    if (refines) {
      add_finding(findings, "change",
                  "modes are refined beside one force alone: leave change or other_contacts out");
    }
  }
  if (refines && unchanged) {
    add_finding(findings, "unchanged",
                "modes that change: refines cannot be held: leave one of the two out");
  }
  if (refines && record.responses.size() == 1) {
    add_finding(findings, "record.responses",
                "one response is explained by any model and some force: modes are refined by the "
                "responses of two sensors and more");
  }
  return findings;
}

void IdentifyForceOptions::lint_tables(const std::filesystem::path& folder,
                                       std::vector<SensorKind>& kinds,
                                       std::vector<Finding>& findings) const {
  double low = 0.0, high = std::numeric_limits<double>::infinity();
  const auto lint_contour = [&](const StructureTable& told, const std::string& file) {
    const double least = told.measured.grid.sigma;
    if (!(contour < least)) return;
    add_finding(findings, "contour",
                "the response functions of {} were weighted by an exponential window, which is a "
                "contour of {:g} 1/s: state that or more",
                file, least);
  };
  lint_making(findings, "table", [&] {
    const StructureTable told = read_table(folder / table);
    kinds = told.model.sensors;
    low = told.low, high = told.high;
    if (refines) told.require_modes("change:");
    lint_contour(told, table);
  });
  const auto of_same_sensors = [&](const std::string& file) {
    StructureTable other = read_table(folder / file);
    MODCAL_REQUIRE(kinds.empty() || other.model.sensors == kinds,
                   "{} has other sensors than {}: fit both to the same channels", file, table);
    return other;
  };
  for (std::size_t i = 0; i < other_places.size(); ++i) {
    lint_making(findings, fmt::format("other_places.{}", i),
                [&] { of_same_sensors(other_places[i]); });
  }
  for (std::size_t i = 0; i < other_contacts.size(); ++i) {
    const std::string& file = other_contacts[i];
    lint_making(findings, fmt::format("other_contacts.{}", i), [&] {
      const StructureTable other = of_same_sensors(file);
      lint_contour(other, file);
      low = std::max(low, other.low), high = std::min(high, other.high);
      MODCAL_REQUIRE(low < high,
                     "the band of {} has nothing in common with that of those before: fit all "
                     "tables in the same band",
                     file);
    });
  }
}

std::vector<Finding> IdentifyForceOptions::lint_records(const std::filesystem::path& folder) const {
  std::vector<Finding> findings;
  std::size_t sensors = 0;
  std::vector<SensorKind> kinds;
  lint_tables(folder, kinds, findings);
  lint_making(findings, "record", [&] {
    const LoadedStructureRecord loaded = load_structure_record(record, folder);
    sensors = loaded.kinds.size();
    if (write_sound) lint_sound("write_sound", loaded.record.sample_rate, findings);
    if (kinds.empty()) return;
    if (sensors != kinds.size()) {
      throw WrongKey(
          "record.responses",
          fmt::format("{} responses for a table of {} sensors: name the same channels in "
                      "its order",
                      sensors, kinds.size()));
    }
    for (std::size_t k = 0; k < sensors; ++k) {
      if (loaded.kinds[k] == kinds[k]) continue;
      throw WrongKey(fmt::format("record.responses.{}.kind", k),
                     fmt::format("response {} is {}, in the table {}", k + 1,
                                 name_of(loaded.kinds[k]), name_of(kinds[k])));
    }
    if (window > loaded.record.duration()) {
      throw WrongKey("window", fmt::format("window = {:g} s is longer than the record, {:g} s",
                                           window, loaded.record.duration()));
    }
  });
  return findings;
}

}  // namespace modcal
