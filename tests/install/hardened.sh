#!/usr/bin/env bash
# Whether programs and libraries have the protections of PHOTORQUE_HARDEN, as the ELF files say.
#   hardened.sh FILE ...       those files
#   hardened.sh --options SOURCE_FOLDER   a small program with the options of the build: hardened it has
#                                         all of them, without it does not
#   hardened.sh --search FILE ...         whether they look for libraries in the folder in which they are
#                                         started, or below it
set -euo pipefail

# Prints the protections that a file lacks.
missing() {
  local file="$1" headers segments dynamic symbols
  headers="$(readelf -hW "$file")"
  segments="$(readelf -lW "$file")"
  dynamic="$(readelf -dW "$file")"
  symbols="$(readelf -W --dyn-syms "$file")"
  grep -q 'Type: *DYN' <<<"$headers" || echo "any address (PIE)"
  grep -q 'GNU_RELRO' <<<"$segments" || echo "tables that are read-only after the start (RELRO)"
  grep -q 'GNU_STACK.* RW ' <<<"$segments" || echo "a stack that cannot be run"
  grep -qE 'BIND_NOW|Flags:.*\bNOW\b' <<<"$dynamic" || echo "symbols that are all bound at the start (now)"
  if grep -q 'TEXTREL' <<<"$dynamic"; then echo "code that stays as it is"; fi
  grep -q '__stack_chk_fail' <<<"$symbols" || echo "guarded stacks (-fstack-protector-strong)"
  grep -qE '__[a-z]+_chk\b' <<<"$(grep -v stack_chk <<<"$symbols")" || echo "checked copies (_FORTIFY_SOURCE)"
  # endbr64 at what may be jumped to; the start files of the C library bring two.
  [[ "$(objdump -d -j .text "$file" | grep -c endbr64)" -ge 4 ]] || echo "marked entries (-fcf-protection)"
}

# Prints the entries of a file's search path that are neither absolute nor beside the file itself. An
# empty one is the folder in which it is started.
loose_paths() {
  readelf -dW "$1" | sed -nE 's/.*\((RPATH|RUNPATH)\).*\[(.*)\]/\2:/p' | tr ':' '\n' | sed '$d' |
    grep -vE '^(/|\$ORIGIN|\$\{ORIGIN\})' | sed 's/^$/(the folder in which it is started)/' || true
}

# Says of each file what a function prints of it; fails where it prints anything.
tell() {  # words, function, file ...
  local words="$1" of="$2" status=0
  for file in "${@:3}"; do
    while read -r found; do
      echo "$file $words $found"
      status=1
    done < <("$of" "$file")
  done
  return "$status"
}

if [[ "${1:-}" == "--search" ]]; then
  # The checks find missing protections.
  place="$(mktemp -d)"
  trap 'rm -rf "$place"' EXIT
  echo 'int main() {}' >"$place/empty.cpp"
  for path in /usr/lib: :/usr/lib lib /usr/lib::/lib; do
    c++ "$place/empty.cpp" -o "$place/loose" -Wl,-rpath,"$path"
    [[ -n "$(loose_paths "$place/loose")" ]] || { echo "a search path of $path is not found"; exit 1; }
  done
  c++ "$place/empty.cpp" -o "$place/firm" -Wl,-rpath,'/usr/lib:$ORIGIN/../lib'
  [[ -z "$(loose_paths "$place/firm")" ]]
  tell "looks for libraries in" loose_paths "${@:2}"
  exit
fi

if [[ "${1:-}" == "--options" ]]; then
  source="$2"
  place="$(mktemp -d)"
  trap 'rm -rf "$place"' EXIT
  for harden in ON OFF; do
    cmake -S "$source/tests/install/hardened" -B "$place/$harden" -G Ninja -DPHOTORQUE_SOURCE="$source" \
      -DPHOTORQUE_HARDEN="$harden" >/dev/null
    cmake --build "$place/$harden" >/dev/null
    missing "$place/$harden/hardened" >"$place/$harden.missing"
    echo "hardened $harden misses: $(paste -sd, "$place/$harden.missing")"
  done
  [[ ! -s "$place/ON.missing" ]]
  for protection in now fstack-protector _FORTIFY_SOURCE fcf-protection; do
    grep -q "$protection" "$place/OFF.missing"
  done
  # Large frames are touched page by page.
  # (A reader that stops early would end objdump by a signal.)
  touches() { grep -qE 'or[ql]? +[$]0x0,.*[(]%rsp[)]' <<<"$(objdump -d "$1/hardened")"; }
  touches "$place/ON"
  if touches "$place/OFF"; then exit 1; fi
  # Its own path does not fit into the buffer.
  if ("$place/ON/hardened" || exit 1) >/dev/null 2>&1; then exit 1; fi
  exit 0
fi

tell lacks missing "$@"
