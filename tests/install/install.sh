#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: install.sh BUILD_DIR PREFIX
#
# Installs a build into PREFIX and uses what lies there: the program runs from anywhere, every verb
# has its manual page, completions and schema are what the program prints.
set -euo pipefail

build=$1
prefix=$2
rm -rf "$prefix"
if ! cmake --install "$build" --prefix "$prefix" > "$build/install.log" 2>&1; then
  tail -20 "$build/install.log"
  exit 1
fi

fail() {
  echo "install: $*"
  exit 1
}

glint=$prefix/bin/glint
cd /
env -i PATH=/usr/bin:/bin "$glint" --version | grep -q '^glint [0-9]' || fail "the program does not run"
cmp -s <("$glint" explain --schema) "$prefix/share/glint/study.schema.json" || fail "schema differs"
cmp -s <("$glint" help --completion bash) "$prefix/share/bash-completion/completions/glint" ||
  fail "bash completion differs"
zsh=$(find "$prefix/share/zsh" -name _glint)
cmp -s <("$glint" help --completion zsh) "$zsh" || fail "zsh completion differs"
cmp -s <("$glint" help --completion fish) "$prefix/share/fish/vendor_completions.d/glint.fish" ||
  fail "fish completion differs"

verbs=$("$glint" --help | sed -n '/^Verbs:/,/^$/s/^  \([a-z]\+\) .*/\1/p')
[ "$(wc -w <<< "$verbs")" -ge 11 ] || fail "the help names few verbs: $verbs"
for verb in $verbs; do
  grep -q "^\.SH SYNOPSIS" "$prefix/share/man/man1/glint-$verb.1" || fail "no manual page of $verb"
done
[ "$(find "$prefix/share/man/man1" -type f | wc -l)" -eq "$(($(wc -w <<< "$verbs") + 1))" ] ||
  fail "a manual page of no verb"
for document in README.md CHANGELOG.md LICENSE docs/tour.md docs/images; do
  [ -e "$prefix/share/doc/glint/$document" ] || fail "no $document"
done
echo "installed $(find "$prefix" -type f | wc -l) files, all as they should be"
