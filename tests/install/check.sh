#!/usr/bin/env bash
# Installs into a separate folder and uses the result as another project would: a CMake project, pkg-config,
# the manual page, the completions.
#   check.sh BUILD_FOLDER SOURCE_FOLDER
set -euo pipefail
build="$1"
source="$2"
place="$(mktemp -d)"
trap 'rm -rf "$place"' EXIT
prefix="$place/prefix"
cmake --install "$build" --prefix "$prefix" >/dev/null

echo "== find_package"
cmake -S "$source/tests/install/example" -B "$place/example" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
cmake --build "$place/example"
"$place/example/client"
cat >"$place/CMakeLists.txt" <<'C'
cmake_minimum_required(VERSION 3.24)
project(other LANGUAGES CXX)
find_package(photorque 0.1 REQUIRED COMPONENTS library gui)
C
if cmake -S "$place" -B "$place/other" -DCMAKE_PREFIX_PATH="$prefix" >"$place/other.log" 2>&1; then exit 1; fi
grep -q 'gui' "$place/other.log"
"$place/example/example" "$source/scenes/stasis/nominal.toml" | tee "$place/said"
"$prefix/bin/photorque" trace "$prefix/share/photorque/scenes/stasis/nominal.toml" --set trace.rays=65536 \
  --out "$place/out" --quiet
absorbed="$(sed -n 's/^absorbed \(.*\) W$/\1/p' "$place/said")"
# The program and a project with the library find the same number, to the last bit.
/usr/bin/python3 - "$place/out/summary.json" "$absorbed" <<'P'
import json, sys
assert json.load(open(sys.argv[1]))["absorbed_W"]["value"] == float(sys.argv[2]), sys.argv
P
grep -q '^error absent.toml: ' "$place/said"
grep -qE '^tilt 0\.[0-9]+ rad$|^tilt [0-9.]+e-[0-9]+ rad$' "$place/said"

if grep -q '^PHOTORQUE_HARDEN:BOOL=ON' "$build/CMakeCache.txt"; then
  echo "== Hardened"
  "$source/tests/install/hardened.sh" "$prefix/bin/photorque" $(find "$prefix" -path '*/photorque/*.so') \
    "$(find "$prefix" -name 'libphotorque.so.*.*.*')"
fi

echo "== Libraries from their own places alone"
"$source/tests/install/hardened.sh" --search "$prefix/bin/photorque" $(find "$prefix" -path '*/photorque/*.so') \
  "$(find "$prefix" -name 'libphotorque.so.*.*.*')"

echo "== Only our own symbols"
library="$(find "$prefix" -name 'libphotorque.so.*.*.*')"
foreign="$(nm -D --defined-only -C "$library" | grep -cvE 'photorque::' || true)"
echo "$foreign of $(nm -D --defined-only "$library" | wc -l) are not"
[[ "$foreign" -eq 0 ]]

echo "== Headers: nothing missing, nothing of others"
for header in $(cd "$prefix/include/photorque" && find . -path ./core/precompiled.h -prune -o -name '*.h' -print); do
  for included in $(sed -n 's/^#include "\(.*\)".*/\1/p' "$prefix/include/photorque/$header"); do
    [[ -f "$prefix/include/photorque/$included" ]] || { echo "$header includes $included"; exit 1; }
  done
done
if grep -rE '#include <(embree|tbb|OpenImageIO|tiffio|nlohmann|CLI|toml|cairo)' "$prefix/include"; then exit 1; fi

echo "== pkg-config"
PKG_CONFIG_PATH="$(dirname "$(find "$prefix" -name photorque.pc)")"
export PKG_CONFIG_PATH
[[ -f "$(pkg-config --variable=includedir photorque)/photorque/tools/verbs/trace.h" ]]
[[ -f "$(pkg-config --variable=libdir photorque)/libphotorque.so" ]]
pkg-config --modversion --cflags --libs-only-l photorque

echo "== The C header of serve"
gcc -std=c99 -Wall -Wextra -Werror -pedantic -I "$prefix/include" -o "$place/client" \
  "$source/tests/install/example/client.c"
"$place/client"

echo "== Manual page and completions"
verbs="$("$prefix/bin/photorque" --help | sed -n 's/^  \([a-z][a-z-]*\)  .*/\1/p')"
for file in man/man1/photorque.1 bash-completion/completions/photorque zsh/vendor-completions/_photorque \
  fish/vendor_completions.d/photorque.fish; do
  text="$(sed 's/\\-/-/g' "$prefix/share/$file")"
  for verb in $verbs; do
    grep -qw -- "$verb" <<<"$text" || { echo "$file does not name $verb"; exit 1; }
  done
done
bash -n "$prefix/share/bash-completion/completions/photorque"
# shellcheck disable=SC1091
(source "$prefix/share/bash-completion/completions/photorque"
 COMP_WORDS=(photorque pro) COMP_CWORD=1 && _photorque && [[ "${COMPREPLY[*]}" == "propagate" ]]
 COMP_WORDS=(photorque trace x.toml --tar) COMP_CWORD=3 && _photorque && [[ "${COMPREPLY[*]}" == "--target-error" ]])
if command -v zsh >/dev/null; then
  completed() { timeout 60 zsh -f "$source/tests/install/completes.zsh" "$prefix/share/zsh/vendor-completions" "$1"; }
  [[ "$(completed 'photorque prop')" == "photorque propagate " ]]
  [[ "$(completed 'photorque trace x.toml --targ')" == "photorque trace x.toml --target-error " ]]
fi
echo "$(wc -w <<<"$verbs") commands"
