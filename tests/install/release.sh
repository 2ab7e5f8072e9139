#!/usr/bin/env bash
# Unpacks the archive of tools/release into a root that holds the C library and nothing else, and runs
# the main job and the self-test there. Skipped (77) where no such root can be entered.
#   release.sh BUILD_FOLDER SOURCE_FOLDER
set -euo pipefail
build="$1"
source="$2"
place="$(mktemp -d)"
trap 'rm -rf --one-file-system "$place"' EXIT
root="$place/root"
mkdir -p "$root"/{proc,tmp,opt,results,lib64,lib/x86_64-linux-gnu}
enter=(unshare --mount --pid --fork "--mount-proc=$root/proc" chroot "$root")
if [[ $(id -u) -ne 0 ]]; then enter=("${enter[0]}" --user --map-root-user "${enter[@]:1}"); fi
cp -L /lib64/ld-linux-x86-64.so.2 "$root/lib64/"
for library in c m dl rt pthread util resolv mvec nsl anl; do
  cp -L "/lib/x86_64-linux-gnu/lib$library.so".[0-9] "$root/lib/x86_64-linux-gnu/" 2>/dev/null || true
done
cp "$(type -P true)" "$root/tmp/true"
if ! "${enter[@]}" /tmp/true; then
  echo "Skipped: no rights to enter another root"
  exit 77
fi

echo "== Archive"
"$source/tools/release" --archive "$build" "$place/out"
begin=$(date +%s%N)
tar -xf "$place"/out/photorque-*-linux-x86_64.tar.gz -C "$root/opt"
mv "$root"/opt/photorque-* "$root/opt/photorque"

echo "== Main job"
photorque=(env -i "PATH=$PATH" HOME=/tmp TMPDIR=/tmp "${enter[@]}" /opt/photorque/bin/photorque)
"${photorque[@]}" power /opt/photorque/share/photorque/scenes/stasis/nominal.toml --set trace.rays=65536 \
  --out /results/power --quiet 2>"$place/said"
echo "from the archive to the first picture: $((($(date +%s%N) - begin) / 1000000)) ms"
cat "$place/said"
[[ ! -s "$place/said" ]] # no word of a missing font or library
# The pictures have letters: they are those that the program in the build folder draws.
"$build/photorque" power "$source/scenes/stasis/nominal.toml" --set trace.rays=65536 --out "$place/power" --quiet
for picture in "$place"/power/*.png; do cmp "$picture" "$root/results/power/$(basename "$picture")"; done

echo "== Self-test"
"${photorque[@]}" selftest | tail -1
