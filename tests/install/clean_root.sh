#!/usr/bin/env bash
# Installs the Debian package on a clean Debian 12 (debootstrap, as root; needs a mirror and some minutes, so
# that it is no part of CTest) and uses it there.
#   clean_root.sh PACKAGE.deb [ROOT]     ROOT: a system by debootstrap to copy; without one it is made
set -euo pipefail
package="$(readlink -f "$1")"
place="$(mktemp -d)"
unmount() {
  mountpoint -q "$place/root/proc" && umount "$place/root/proc"
  rm -rf --one-file-system "$place"
}
trap unmount EXIT
if [[ -n "${2:-}" ]]; then
  cp -a "$2" "$place/root"
else
  debootstrap --variant=minbase bookworm "$place/root" "${DEBIAN_MIRROR:-http://deb.debian.org/debian}" >/dev/null
fi
cp /etc/resolv.conf "$place/root/etc/resolv.conf"
if compgen -G '/etc/apt/apt.conf.d/*proxy*' >/dev/null; then cp /etc/apt/apt.conf.d/*proxy* "$place/root/etc/apt/apt.conf.d/"; fi
mount -t proc proc "$place/root/proc"
cp "$package" "$place/root/tmp/photorque.deb"
cat >"$place/root/tmp/use.sh" <<'S'
set -euo pipefail
export DEBIAN_FRONTEND=noninteractive
# Debian's images for containers leave documents out; a machine does not.
rm -f /etc/dpkg/dpkg.cfg.d/docker
before="$(dpkg -l | grep -c '^ii')"
apt-get update -qq
apt-get install -y -qq --no-install-recommends /tmp/photorque.deb man-db bash-completion zsh fish >/dev/null 2>&1
echo "Debian $(cat /etc/debian_version): $before packages before, $(dpkg -l | grep -c '^ii') after"
photorque --version
photorque trace /usr/share/photorque/scenes/stasis/nominal.toml --set trace.rays=65536 --page --out /tmp/out --quiet
ls -s /tmp/out/page.html /tmp/out/irradiance_solar_array.png
photorque selftest | tail -1
echo "== man page"
man -P cat photorque 2>/dev/null | sed -n '1,6p'
echo "== completions"
bash -ic 'source /usr/share/bash-completion/bash_completion; _completion_loader photorque; COMP_WORDS=(photorque pro); COMP_CWORD=1
  "$(complete -p photorque | sed "s/.*-F \([^ ]*\).*/\1/")"; echo "bash: ${COMPREPLY[*]}"' 2>/dev/null
zsh -c 'autoload -Uz compinit && compinit -u -D && print "zsh: ${_comps[photorque]}"'
fish -c 'echo fish: (complete -C "photorque pro" | string replace -r "\t.*" "")'
S
chroot "$place/root" bash /tmp/use.sh
