#!/usr/bin/env bash
# build_site.sh OUT: the pages of this folder as a site in OUT, by mkdocs (Debian package mkdocs); links are checked, and a
# wrong one fails. Pages ask for nothing from elsewhere.
set -euo pipefail
docs=$(cd "$(dirname "$0")" && pwd)
out=$(realpath -m "$1")
configuration=$(mktemp --suffix=.yml)
trap 'rm -f "$configuration"' EXIT
cat > "$configuration" << END
site_name: groundloop
site_description: Offline LiDAR SLAM for recorded sequences
docs_dir: $docs
site_dir: $out
use_directory_urls: false
theme: {name: mkdocs, highlightjs: false}
plugins: [search]
nav:
  - Start: index.md
  - Users:
      - Sensors and formats: formats.md
      - Merging and fleets: merging.md
      - The session's files: session.md
      - Troubleshooting: troubleshooting.md
      - Accuracy and speed: accuracy.md
  - Developers:
      - The method: method.md
      - Other programs: programs.md
      - Extending: extending.md
  - Changes: changelog.md
END
mkdocs build --strict --clean --config-file "$configuration"
# Nothing may be asked for from elsewhere.
if grep -rlE '(src|href)="(https?:)?//[^"]*\.(js|css|woff2?)' "$out" --include='*.html'; then
  echo "build_site.sh: these pages ask for files from elsewhere" >&2
  exit 1
fi
rm -f "$out"/*.sh "$out/sitemap.xml.gz"
