// Where results come from: version, commit, compiler, libraries, machine, command, time.
#pragma once

#include <nlohmann/json.hpp>

#include "experiments/loader.hpp"

namespace modcal {

std::string version_text();
/// Equal for programs that give equal results: version and commit, and for a program built from
/// changed sources the file itself.
std::string program_identity();
nlohmann::ordered_json provenance_json(const std::string& command);
/// The seeds of an experiment by their paths, a swept one as its list.
nlohmann::ordered_json seeds_json(const LoadedExperiment& loaded);
std::vector<report::ProvenanceLine> provenance_lines(const std::string& command);

}  // namespace modcal
