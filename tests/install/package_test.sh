#!/usr/bin/env bash
# The Debian package of what is built: it is made, installed by dpkg below a folder of its own and used there, and
# neither it nor what it writes holds a path of the machine that built it; that of Python, where it is built, likewise.
# Removed, it leaves nothing.
# package_test.sh ROOT BUILD CPACK
set -euo pipefail
root=$(cd "${1:?usage: package_test.sh ROOT BUILD CPACK}" && pwd)
build=$(cd "$2" && pwd) cpack=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "$*"; exit 1; }
quietly() { "$@" >"$work/log" 2>&1 || fail "$(cat "$work/log")"; }

quietly "$cpack" -G DEB --config "$build/CPackConfig.cmake" -B "$work/made"
package=$(ls "$work"/made/modcal_*.deb) python=$(find "$work/made" -maxdepth 1 -name "python3-modcal_*.deb")
field() { dpkg-deb --field "$package" "$1"; }
[ "$(field Package)" = modcal ] || fail "the package is called $(field Package)"
for library in libc6 libfftw3-double3 libyaml-cpp; do
  field Depends | grep -q "$library" || fail "the package does not depend on $library: $(field Depends)"
done
# What it depends on is installed on this machine and not below the folder.
mkdir -p "$work/there/var/lib/dpkg/info" "$work/there/var/lib/dpkg/updates"
: >"$work/there/var/lib/dpkg/status"
below() { dpkg --root="$work/there" --force-not-root,depends --log=/dev/null "$@"; }
# shellcheck disable=SC2086 # no package of Python is no word
quietly below --install "$package" $python
[ "$(dpkg-query --admindir="$work/there/var/lib/dpkg" --show --showformat='${db:Status-Status}' modcal)" = installed ] || fail "dpkg has not installed it"
there=$work/there/usr
for file in bin/modcal lib/libmodcal_calib.a include/modcal/libcalib/calibration.hpp \
  lib/cmake/modcal/modcalConfig.cmake lib/pkgconfig/modcal-calib.pc share/modcal/configs/paper/table1.yaml \
  share/doc/modcal/README.md share/doc/modcal/docs/commands.md share/man/man1/modcal.1.gz \
  share/doc/modcal/copyright share/doc/modcal/changelog.gz \
  share/bash-completion/completions/modcal share/zsh/vendor-completions/_modcal \
  share/fish/vendor_completions.d/modcal.fish; do
  [ -s "$there/$file" ] || fail "the package lacks $file"
done

if command -v lintian >/dev/null; then
  # Who maintains it and where programs for other machines are built is for who packages it.
  others=bogus-mail-host,bogus-mail-host-in-debian-changelog,pkg-config-unavailable-for-cross-compilation
  # shellcheck disable=SC2086 # no package of Python is no word
  quietly lintian --allow-root --fail-on error,warning --suppress-tags "$others" "$package" $python
fi

names_the_machine() { strings -a "$1" | grep -F -e "$root" -e "$build"; }
printf 'text %s text' "$build" >"$work/planted"
names_the_machine "$work/planted" >/dev/null || fail "self-check: a path goes unnoticed"
none_names_the_machine() { # FOLDER
  while IFS= read -r -d '' file; do
    if names_the_machine "$file"; then fail "$file names the machine it was built on"; fi
  done < <(find "$1" -type f -print0)
}
none_names_the_machine "$there"

cd "$work" # away from the tree
[ "$("$there/bin/modcal" man)" = "$(gzip -dc "$there/share/man/man1/modcal.1.gz")" ] || fail "another manual page"
quietly "$there/bin/modcal" reproduce fig02
[ -s out/fig02/report.html ] || fail "there is no report"
none_names_the_machine out
quietly "$there/bin/modcal" new calibrate --out mine.yaml
quietly "$there/bin/modcal" validate mine.yaml
if [ -n "$python" ]; then
  mkdir -p "$work/root/var/lib/dpkg/info" "$work/root/var/lib/dpkg/updates"
  touch "$work/root/var/lib/dpkg/status"
  # What it depends on is that of this machine.
  quietly dpkg --root="$work/root" --force-not-root,depends,script-chrootless --log="$work/dpkg.log" -i "$python"
  dpkg-query --admindir="$work/root/var/lib/dpkg" -W -f='${db:Status-Status}' python3-modcal | grep -qx installed ||
    fail "the package of Python is not installed"
  export PYTHONPATH=$work/root/usr/lib/python3/dist-packages
  quietly /usr/bin/python3 - "$PYTHONPATH" <<'EOF'
import sys

import modcal

assert modcal.__file__.startswith(sys.argv[1]), modcal.__file__
assert not modcal.validate("mine.yaml"), modcal.validate("mine.yaml")
string = {"length": 0.33, "linear_density": 3.1e-3, "fundamental": 196, "modes": 12}
stroke = modcal.simulate(scene={"string": string, "bow": {"position": 0.03}, "duration": 0.1},
                         simulator={"type": "modal_event"}, measurement={"sample_rate": 12800})
found = modcal.invert(modcal.Record(rate=12800, left=stroke.R1, right=stroke.R2), string, 0.03)
assert found.f_c_joint.shape == stroke.f_c.shape
EOF
fi
# shellcheck disable=SC2046 # two words with the package of Python
quietly below --purge modcal $([ -z "$python" ] || echo python3-modcal)
left=$([ ! -e "$there" ] || find "$there" -mindepth 1 ! -type d)
[ -z "$left" ] || fail "removed, it leaves $left"
