#!/bin/sh
# check_docs.sh PROJECT: scripts/check_docs finds each kind of fault in a copy of
# the documents, and none in the copy as it is.
cd "$1" || exit 1
[ -x /usr/bin/python3 ] || exit 0

status=0
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
for entry in *; do
  case $entry in
    doc | examples | *.md) cp -r "$entry" "$copy" ;;
    build* | output) ;;
    *) ln -s "$PWD/$entry" "$copy" ;;
  esac
done

# finds TEXT FILE SED: after this change of the file, which is undone then, the
# script says so.
finds() {
  cp "$copy/$2" "$copy/saved"
  sed -i "$3" "$copy/$2"
  if cmp -s "$copy/$2" "$copy/saved"; then
    echo "FAILED: $3 changes nothing in $2"
    status=1
  elif scripts/check_docs --root "$copy" >"$copy/log" || ! grep -qF -- "$1" "$copy/log"; then
    echo "FAILED: not found in $2: $1"
    cat "$copy/log"
    status=1
  fi
  mv "$copy/saved" "$copy/$2"
}

scripts/check_docs --root "$copy" >"$copy/log" || {
  cat "$copy/log"
  exit 1
}
user=doc/user
finds "leads nowhere" $user/index.md 's/(first_run.md)/(first_walk.md)/'
finds "has no heading" $user/bodies.md 's/contact.md#rigid-bodies/contact.md#rigid-body/'
finds "no option --fields" $user/output.md 's/picture --field /picture --fields /'
finds "there is no file" $user/first_run.md 's/dam_break.prm/dam_broke.prm/'
finds "there is no script" $user/output.md 's|^scripts/picture|scripts/draw|'
finds "no parameter Stage collapse/Time/CFL numbers" $user/first_file.md 's/set CFL number /set CFL numbers/'
finds "no section Bodies soil" $user/examples/vertical_cut.prm 's/subsection Body soil/subsection Bodies soil/'
finds "no parameter Scheme/Masses" $user/choosing.md 's|`Scheme/Mass`|`Scheme/Masses`|'
finds "no message" $user/troubleshooting.md 's/is a folder, not a/is a folder and no/'
finds "no row for kinetic" $user/output.md '/^| `kinetic`/d'
finds "no link to examples/slope_failure/README.md" README.md 's|examples/slope_failure/README.md|examples/slope_failure|'
finds "in no file that the page links to" doc/developer/adding_a_law.md 's/2\. + e\.norm()/3. + e.norm()/'
finds "has a function compute_statistics" doc/developer/adding_a_field.md 's/`add_sums()`/`compute_statistics()`/'
rooms=doc/developer/architecture.md
finds "no arrows lead from mass to spline" $rooms '/^  mass --> spline/d'
finds "no file of materials includes one of spline" $rooms 's/^  materials --> base/&\n  materials --> spline/'
dox=doc/developer/step.dox
finds "no header declares EnergyGuard::check" $dox 's/StepGuard::check/EnergyGuard::check/'
finds "no header declares GridMass::renew" $dox 's/GridMass::update/GridMass::renew/'
finds "no parameter Stress updates" $dox '1s,$, <code>Stress updates = USL</code>,'
finds "there is no file tests/paper/level.cc" doc/step-greville/doc/results.dox 's|level_operator.cc|level.cc|'
exit $status
