#include "benchmarks/truth/truth_files.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>

#include "benchmarks/truth/decimator.hpp"

namespace modcal::truth {
namespace {

using nlohmann::ordered_json;

std::ofstream opened(const std::filesystem::path& path) {
  std::ofstream file(path);
  if (!file) throw std::runtime_error(path.string() + ": cannot be written");
  return file;
}

void finish(std::ofstream& file, const std::filesystem::path& path) {
  if (!file.flush()) throw std::runtime_error(path.string() + ": writing failed");
}

ordered_json json_of(const Course& course) {
  ordered_json knots = ordered_json::array();
  for (const Knot& knot : course) knots.push_back({knot.time, knot.value});
  return knots;
}

ordered_json json_of(const ExponentialFriction& law) {
  return {{"type", "exponential"},
          {"static", law.static_coefficient},
          {"dynamic", law.dynamic_coefficient},
          {"decay", law.decay}};
}

ordered_json json_of(const ThermalFriction& law) {
  return {{"type", "thermal"},
          {"cold", law.cold_coefficient},
          {"hot", law.hot_coefficient},
          {"softening_rise", law.softening_rise},
          {"softening_width", law.softening_width},
          {"heat_capacity", law.heat_capacity},
          {"conductance", law.conductance},
          {"carried_heat", law.carried_heat}};
}

ordered_json json_of(const TruthBow& bow) {
  return {{"type", "bow"},
          {"velocity", json_of(bow.velocity)},
          {"normal_force", json_of(bow.normal_force)},
          {"friction", std::visit([](const auto& law) { return json_of(law); }, bow.friction)}};
}

ordered_json json_of(const TruthForce& stated) {
  return {{"type", "force"}, {"force", json_of(stated.force)}};
}

ordered_json json_of(const TruthPluck& pluck) {
  return {{"type", "pluck"}, {"height", pluck.height}, {"width", pluck.width}};
}

ordered_json json_of(const TruthString& string) {
  ordered_json result = {{"f0", string.fundamental},
                         {"B", string.inharmonicity},
                         {"L", string.length},
                         {"rho_L", string.linear_density},
                         {"T", string.tension()},
                         {"EI", string.bending()},
                         {"damping",
                          {{"law", "sigma_n = s0 + s1 (n pi/L)^2, zeta_n = sigma_n/(2 pi f_n)"},
                           {"s0", string.loss},
                           {"s1", string.diffusion}}}};
  if (const auto& torsion = string.torsion) {
    result["torsion"] = {{"speed_ratio", torsion->speed_ratio},
                         {"impedance_ratio", torsion->impedance_ratio},
                         {"s0", torsion->loss},
                         {"s1", torsion->diffusion}};
  }
  return result;
}

ordered_json json_of(const TruthAudit& audit) {
  return {{"energy_residual", audit.residual()},
          {"stored", audit.stored},
          {"lost", audit.lost},
          {"bow_work", audit.bow_work},
          {"heat", audit.heat},
          {"friction_violation", audit.friction_violation}};
}

ordered_json json_of(const TruthMismatch& m) {
  return {{"gain", m.gain},
          {"delay", m.delay},
          {"corner", m.corner},
          {"body", {{"peak", m.body_peak}, {"f", m.body_frequency}, {"zeta", m.body_damping}}},
          {"polarization", {m.polarization[0], m.polarization[1]}},
          {"detuning", m.detuning},
          {"drift", m.drift},
          {"wander", m.wander},
          {"wander_frequency", m.wander_frequency},
          {"bridge_mass", m.bridge_mass}};
}

}  // namespace

void write_record(const std::filesystem::path& path, const TruthRecord& record) {
  std::ofstream file = opened(path);
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "t [s],R1 [N],R2 [N],f_c [N],y [m],v [m/s]\n");
  for (std::size_t i = 0; i < record.r1.size(); ++i) {
    fmt::format_to(std::back_inserter(text), "{:.12g},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g}\n",
                   static_cast<double>(i) / record.rate, record.r1[i], record.r2[i], record.f[i],
                   record.y[i], record.v[i]);
  }
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  finish(file, path);
}

void write_truth(const std::filesystem::path& path, const TruthString& string,
                 const TruthGesture& gesture, const TruthOptions& options,
                 const TruthRecord& record) {
  ordered_json f = ordered_json::array(), zeta = ordered_json::array();
  for (const WaveMode& mode : record.modes) {
    f.push_back(mode.omega / (2.0 * std::numbers::pi));
    zeta.push_back(mode.decay / mode.omega);
  }
  const bool support = options.reactions == Reactions::kSupport;
  ordered_json reactions = {
      {"kind", support ? "support" : "tension"},
      {"definition", support ? "-T y'(0) + EI y'''(0), T y'(L) - EI y'''(L)" : "-T y'(0), T y'(L)"},
      {"bending", support},
      {"boundary_damping", false}};
  ordered_json scheme = {{"rate", record.internal_rate},
                         {"intervals", record.intervals},
                         {"half_width", options.half_width}};
  const double pass = options.filtered ? Decimator::kPass * record.rate : 0.5 * record.rate;
  const ordered_json result = {
      {"string", json_of(string)},
      {"x_c", gesture.position},
      {"gesture", std::visit([](const auto& action) { return json_of(action); }, gesture.action)},
      {"reactions", reactions},
      {"record",
       {{"rate", record.rate},
        {"start", options.start},
        {"samples", record.r1.size()},
        {"anti_alias_filter", options.filtered},
        {"flat_to", pass},
        {"ripple", options.filtered ? Decimator::kRipple : 0.0}}},
      {"mismatch", json_of(options.mismatch)},
      {"noise",
       {{"level", options.noise_level},
        {"seed", options.seed},
        {"R1", record.noise[0]},
        {"R2", record.noise[1]}}},
      {"motion", {{"stuck", record.stuck}, {"slips", record.slips}}},
      {"scheme", scheme},
      {"audit", options.audit ? json_of(record.audit) : ordered_json()},
      {"modes", {{"f", f}, {"zeta", zeta}}}};
  std::ofstream file = opened(path);
  file << result.dump(1) << '\n';
  finish(file, path);
}

}  // namespace modcal::truth
