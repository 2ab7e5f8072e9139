#!/usr/bin/env bash
# The container image of the Debian package: built, and used for a trace. Skipped (77) where no builder of
# containers works or the base image is not to be had.
#   image.sh BUILD_FOLDER SOURCE_FOLDER
set -euo pipefail
build="$1"
source="$2"
place="$(mktemp -d)"
trap 'rm -rf "$place"' EXIT
builder=""
for tool in podman docker; do
  if "$tool" info &>/dev/null; then builder="$tool" && break; fi
done
if [[ -z $builder ]]; then
  echo "Skipped: neither podman nor docker works here"
  exit 77
fi
if ! "$builder" pull "$(sed -n 's/^FROM //p' "$source/Containerfile")" >/dev/null; then
  echo "Skipped: the base image cannot be fetched"
  exit 77
fi
ln -s "$build"/* "$place/" # packed beside the build, not in it
rm -f "$place/package"
"$source/tools/container" pack "$place"
"$source/tools/container" image "$place/package"
cp "$source"/scenes/tabletop/tabletop.{toml,gltf} "$place/package/"
begin=$(date +%s%N)
"$builder" run --rm -v "$place/package:/work" photorque trace tabletop.toml --set trace.rays=65536 --out out --quiet
echo "from the image to the first picture: $((($(date +%s%N) - begin) / 1000000)) ms"
[[ -s "$place/package/out/summary.json" ]]
