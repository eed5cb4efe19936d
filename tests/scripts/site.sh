#!/bin/sh
# site.sh PROJECT: the search of the site of scripts/site knows a parameter, and a lost
# page, a lost heading and a foreign picture are found. Exit status 77 without packages.
cd "$1" || exit 1
. scripts/common.sh
# shellcheck disable=SC2086
dpkg-query -W $site_packages >/dev/null 2>&1 || exit 77

site=$(mktemp -d)
trap 'rm -rf "$site"' EXIT
scripts/site "$site" || exit 1
grep -q '"title": "Filling threshold", "text": "Scheme: ' "$site/search/search_index.json" || exit 1
sed -i '0,/colliding_bars.prm.txt/s//colliding_bar.prm.txt/' "$site/doc/user/contact.html"
sed -i '0,/contact.html#rigid-bodies/s//contact.html#rigid-body/' "$site/doc/user/bodies.html"
sed -i 's|</article>|<img src="https://example.org/a.png"/>&|' "$site/doc/developer/index.html"
scripts/site_pages.py check "$site" >"$site/log" && exit 1
tail -n 4 "$site/log"
[ "$(grep -c 'leads nowhere' "$site/log")" -eq 3 ]
