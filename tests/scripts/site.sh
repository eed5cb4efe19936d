#!/bin/sh
# site.sh PROJECT: scripts/site builds a site without broken links, whose search
# knows a parameter, and finds links that lead nowhere. Exit status 77 without the
# packages that it needs.
cd "$1" || exit 1
. scripts/common.sh
# shellcheck disable=SC2086
dpkg-query -W $site_packages >/dev/null 2>&1 || exit 77

site=$(mktemp -d)
trap 'rm -rf "$site"' EXIT
scripts/site "$site" || exit 1
grep -q '"title": "Filling threshold", "text": "Scheme: ' "$site/search/search_index.json" || exit 1

# finds FILE SED
finds() {
  cp "$site/$1" "$site/saved"
  sed -i "$2" "$site/$1"
  if scripts/site --check "$site" >"$site/log" || [ "$(grep -c "^$1: the link" "$site/log")" -ne 1 ]; then
    echo "FAILED: not found: $2 in $1"
    cat "$site/log"
    exit 1
  fi
  mv "$site/saved" "$site/$1"
}
finds doc/user/contact.html '0,/colliding_bars.prm.txt/s//colliding_bar.prm.txt/'
finds doc/user/bodies.html '0,/contact.html#rigid-bodies/s//contact.html#rigid-body/'
finds doc/developer/index.html 's|</article>|<img src="https://example.org/a.png"/>&|'
