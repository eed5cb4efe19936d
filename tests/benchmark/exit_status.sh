#!/bin/sh
# exit_status.sh PROGRAM...: wrong input ends a run with one message and an exit
# status that is not zero.
if "$@" no_such_file.prm >exit_status.out 2>&1; then
  echo "exit status 0"
  exit 1
fi
cat exit_status.out
[ "$(grep -c 'There is no parameter file <no_such_file.prm>' exit_status.out)" -eq 1 ]
