#!/usr/bin/env bash
# The Debian package holds the program with all that it needs, and Containerfile installs it by the step of
# tools/container. The image itself: image.sh.
#   container.sh BUILD_FOLDER SOURCE_FOLDER
set -euo pipefail
build="$1"
source="$2"
place="$(mktemp -d)"
trap 'rm -rf "$place"' EXIT

echo "== Containerfile"
grep '^RUN ' "$source/Containerfile" | tee "$place/steps"
[[ "$(grep -cE '^RUN /package/container install ' "$place/steps")" -eq "$(wc -l <"$place/steps")" ]]
bash -n "$source/tools/container"
if "$source/tools/container" nothing 2>"$place/said"; then exit 1; fi
for step in pack install image; do grep -q "tools/container $step " "$place/said"; done

echo "== Package"
ln -s "$build"/* "$place/" # packed beside the build, not in it
rm -f "$place/package"
"$source/tools/container" pack "$place"
package="$(ls "$place"/package/*.deb)"
dpkg-deb -x "$package" "$place/root"
for library in $(dpkg-deb -f "$package" Depends | tr ',' '\n' | sed 's/[(|].*//; s/^ *//'); do
  dpkg-query -W -f='${Status}' "$library" | grep -q 'install ok installed' || { echo "$library"; exit 1; }
done
"$place/root/usr/bin/photorque" --version
"$place/root/usr/bin/photorque" trace "$place/root/usr/share/photorque/scenes/tabletop/tabletop.toml" \
  --set trace.rays=65536 --out "$place/out" --quiet
[[ -s "$place/out/summary.json" ]]
for file in share/man/man1/photorque.1 share/bash-completion/completions/photorque share/zsh/vendor-completions/_photorque \
  share/fish/vendor_completions.d/photorque.fish share/doc/photorque/copyright include/photorque_serve.h; do
  ls "$place/root/usr/$file"* >/dev/null
done
