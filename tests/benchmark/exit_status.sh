#!/bin/sh
# exit_status.sh PROGRAM...: wrong input ends a run with one message and an exit
# status that is not zero.
out=exit_status.$$.out
if "$@" no_such_file.prm >"$out" 2>&1; then
  echo "exit status 0"
  exit 1
fi
cat "$out"
[ "$(grep -c 'There is no parameter file <no_such_file.prm>' "$out")" -eq 1 ]
