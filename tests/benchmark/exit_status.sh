#!/bin/sh
# exit_status.sh [MPIEXEC -n N] PROGRAM: the exit status, without lines of
# MPI_Abort. What is printed is in tests/run/command_line.cc.
out=exit_status.$$.out
trap 'rm -f "$out"' EXIT

# ends STATUS MESSAGE PROGRAM ARGUMENT...: with this status, and the message once.
ends() {
  wanted=$1
  message=$2
  shift 2
  status=0
  "$@" >"$out" 2>&1 || status=$?
  if [ $status -ne "$wanted" ] || [ "$(grep -c -e "$message" "$out")" -ne 1 ] ||
    grep -Eq 'MPI_ABORT|[OP]RTE[_ ]ERROR' "$out"; then
    echo "$*: exit status $status, or not one <$message>, or aborted:"
    cat "$out"
    exit 1
  fi
}

ends 0 'Usage: ' "$@" --help
case $* in
  *greville_benchmark)
    ends 1 'There is no parameter file <no_such_file.prm>' "$@" no_such_file.prm
    ;;
  *)
    ends 1 'There is no parameter file <no_such_file.prm>' "$@" --check no_such_file.prm \
      "$(dirname "$0")/../../prm/simulation/elastic_block_2d.prm"
    ;;
esac
