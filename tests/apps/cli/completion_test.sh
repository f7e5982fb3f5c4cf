#!/usr/bin/env bash
# completion_test.sh GROUNDLOOP: what bash offers after some beginnings of lines; that zsh and fish, where they are
# installed, take their scripts and offer commands.
set -euo pipefail
groundloop=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
mkdir folder
touch file.g2o
source <("$groundloop" completion bash)

fail() { echo "completion_test: $*" >&2; exit 1; }

# offered WORD...: what bash would offer for the last word.
offered() {
  COMP_WORDS=(groundloop "$@")
  COMP_CWORD=$#
  COMPREPLY=()
  _groundloop 2> /dev/null
  printf '%s\n' "${COMPREPLY[@]}"
}
# has WANTED LINES: not through a pipe, whose writer fails where grep has seen enough.
has() { grep -qx -- "$1" <<< "$2"; }
expect() { # expect WANTED WORD...
  local wanted=$1
  shift
  local all
  all=$(offered "$@")
  has "$wanted" "$all" || fail "bash: '$*' does not offer '$wanted': ${all//$'\n'/ }"
}
expect_not() {
  local unwanted=$1
  shift
  ! has "$unwanted" "$(offered "$@")" || fail "bash: '$*' offers '$unwanted'"
}

expect run r
expect merge ""
expect trajectory evaluate ""
expect --ground-truth run --g
expect --threads run --t
expect middle run --stamp ""
expect mcap simulate x --layout m
expect folder run --out f
expect_not file.g2o run --out ""
expect file.g2o optimize ""
expect_not file.g2o merge ""
expect --align evaluate trajectory --a
expect_not --align run --a
expect_not man ""

if command -v zsh > /dev/null; then
  "$groundloop" completion zsh > _groundloop
  zsh -n _groundloop || fail "zsh does not take its script"
fi
if command -v fish > /dev/null; then
  "$groundloop" completion fish > groundloop.fish
  export HOME=$work XDG_CONFIG_HOME=$work
  fish_offers() { fish --no-config -c "source groundloop.fish; complete --do-complete '$1'" | cut -f 1; }
  has run "$(fish_offers 'groundloop ru')" || fail "fish: no 'run'"
  has trajectory "$(fish_offers 'groundloop evaluate tra')" || fail "fish: no 'trajectory'"
  has middle "$(fish_offers 'groundloop run --stamp ')" || fail "fish: no 'middle'"
  has --overwrite "$(fish_offers 'groundloop run --ov')" || fail "fish: no '--overwrite'"
fi
echo "completion: all offered"
