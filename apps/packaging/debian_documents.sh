#!/bin/sh
# debian_documents.sh SOURCE OUT VERSION MAINTAINER: changelog.gz and copyright as Debian has them, from the changelog's section of the
# version, the licence, and the licences of what the report embeds.
set -eu
source=$1
out=$2
version=$3
maintainer=$4
mkdir -p "$out"
log=$source/apps/docs/changelog.md
day=$(sed -n "s/^## $version (\(.*\))$/\1/p" "$log")
[ -n "$day" ] || { echo "debian_documents.sh: $log has no section '## $version (YYYY-MM-DD)'" >&2; exit 1; }
{
  printf 'groundloop (%s) stable; urgency=medium\n\n' "$version"
  awk -v head="## $version " 'index($0, head) == 1 {inside = 1; next} /^## / {inside = 0} inside && /^- / {print "  * " substr($0, 3)}' \
    "$log" | tr -d '`' | fold -s -w 78 | sed 's/^\([^ ]\)/    \1/; s/ *$//'
  printf '\n -- %s  %s\n' "$maintainer" "$(LC_ALL=C date -u -R -d "$day 12:00")"
} | gzip -9n > "$out/changelog.gz"
{
  printf 'Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\nUpstream-Name: groundloop\n\n'
  printf 'Files: *\nCopyright: 2026 The groundloop authors\nLicense: Expat\n'
  sed '1,/^Copyright/d; /./,$!d' "$source/LICENSE" | sed 's/^$/./; s/^/ /'
  printf '\nFiles: page embedded in the command\nCopyright: 2010-2019 three.js authors\n 2010-2016 Michael Bostock\nLicense: Expat and BSD-3-clause\n'
  sed 's/^$/./; s/^/ /' "$source/apps/report/page/licences.txt"
} > "$out/copyright"
