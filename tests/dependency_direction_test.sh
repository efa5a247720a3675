#!/usr/bin/env bash
# Greps the includes of the tree and fails on an arrow that points back: every folder may include
# what it stands on, every library has one door. First checks that it would notice:
# dependency_direction_test.sh ROOT.
set -euo pipefail
root=$(cd "${1:?usage: dependency_direction_test.sh ROOT}" && pwd)

# Prints "file:line: include" of every violation below $1; fails when it finds no includes at all.
violations() {
  (cd "$1" && grep -rnE '^[[:space:]]*#[[:space:]]*include' --include='*.[ch]pp' --include='*.[ch]' \
    libsim libinverse libcalib experiments tests benchmarks) | awk '
    function forbid(why) { print place ": " name ": " why }
    {
      split($0, part, ":"); file = part[1]; place = part[1] ":" part[2]
      name = $0; sub(/^[^:]*:[^:]*:/, "", name); sub(/^[^"<]*["<]/, "", name); sub(/[">].*$/, "", name)
      folder = file; sub(/\/.*/, "", folder)
      if (folder == "libsim") folder = file ~ /^libsim\/dynamics\// ? "dynamics" : "model"
      if (file ~ /^libinverse\/model_based\//) folder = "identify"
      if (file ~ /^libinverse\/pluck\//) folder = "pluck"
      test = folder == "tests" || folder == "benchmarks"

      model = "^libsim/(base|signal|model)/"
      allowed["model"] = model
      allowed["dynamics"] = "^libsim/"
      allowed["libinverse"] = model "|^libinverse/(joint/)?[^/]*$"
      allowed["pluck"] = model "|^libinverse/pluck/"
      allowed["identify"] = "^(libsim|libinverse)/"
      allowed["libcalib"] = "^(libsim|libinverse|libcalib)/"
      allowed["experiments"] = "^(libsim|libinverse|libcalib|experiments)/"
      ours = name ~ /^(libsim|libinverse|libcalib|experiments|tests|benchmarks)\//
      if (ours && !test && name !~ allowed[folder]) forbid("points against the dependency direction")

      if (name ~ /^fftw3/ && file != "libsim/signal/fft.cpp") forbid("belongs to libsim/signal/fft.cpp")
      if (test) next
      if (name ~ /^(ceres\/|nlopt|gsl\/)/ && folder != "libcalib") forbid("belongs to libcalib")
      if (name ~ /^(yaml-cpp\/|CLI\/|nlohmann\/|sndfile|csv\.h$|udunits2|converter\.h$)/ &&
          folder != "experiments") forbid("belongs to experiments")
    }
    END { if (NR == 0) { print "no includes found"; exit 1 } }'
}

# Each line: file that gets the include, the include it must not have.
planted() {
  cat <<'EOF'
libsim/base/error.hpp "libsim/dynamics/scene.hpp"
libsim/model/transfer.cpp "libinverse/problem.hpp"
libsim/dynamics/planted.hpp "libcalib/evaluator.hpp"
libinverse/planted.cpp "libsim/dynamics/scene.hpp"
libinverse/planted.cpp "libcalib/evaluator.hpp"
libinverse/planted.cpp "libinverse/model_based/planted.hpp"
libsim/dynamics/planted.hpp "libinverse/model_based/planted.hpp"
libinverse/model_based/planted.cpp "libcalib/evaluator.hpp"
libcalib/planted.cpp "experiments/records/recording.hpp"
experiments/records/recording.cpp "tests/experiments/records/record_folder.hpp"
experiments/records/levels.cpp <fftw3.h>
tests/libsim/model/transfer_test.cpp <fftw3.h>
libinverse/planted.cpp <gsl/gsl_multimin.h>
experiments/records/levels.cpp <nlopt.hpp>
libsim/model/transfer.cpp <ceres/ceres.h>
libcalib/planted.cpp <yaml-cpp/yaml.h>
libcalib/planted.cpp <CLI/CLI.hpp>
libsim/signal/signal.hpp <sndfile.hh>
libinverse/planted.hpp <nlohmann/json.hpp>
libsim/model/transfer.hpp <csv.h>
EOF
}

copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
(cd "$root" && cp -r libsim libinverse libcalib experiments tests benchmarks "$copy")
if ! before=$(violations "$copy"); then
  echo "${before:-no includes found below $root}"
  exit 1
fi
missed=0
while read -r file include; do
  mkdir -p "$copy/$(dirname "$file")"
  [ -e "$copy/$file" ] && cp "$copy/$file" "$copy/saved" || : >"$copy/saved"
  echo "#include $include" >>"$copy/$file"
  if [ "$(violations "$copy")" = "$before" ]; then
    echo "self-check: #include $include in $file goes unnoticed"
    missed=1
  fi
  cp "$copy/saved" "$copy/$file"
done < <(planted)

if [ -n "$before" ]; then
  echo "$before"
  exit 1
fi
exit "$missed"
