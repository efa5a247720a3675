#!/usr/bin/env bash
# Installs the Debian packages of packages.txt that are missing: those without a mark, and those
# marked with one of the purposes given: install_packages.sh [test|python|develop …].
set -euo pipefail
purposes=" $* "
list="$(dirname "$0")/../packages.txt"
missing=()
while read -r name use _; do
  case "$name" in ''|'#'*) continue ;; esac
  [ -n "${use:-}" ] && [[ "$purposes" != *" $use "* ]] && continue
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null)" = installed ] || missing+=("$name")
done <"$list"
[ ${#missing[@]} -eq 0 ] && exit 0
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
echo "installing: ${missing[*]}" >&2
"${as_root[@]}" apt-get update -qq
DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
