#!/bin/sh
# exit_status.sh [MPIEXEC -n N] PROGRAM: wrong input ends a run with one message
# and an exit status that is not zero, without lines of MPI_Abort; help and
# version end well.
out=exit_status.$$.out
trap 'rm -f "$out"' EXIT

fail() {
  echo "$1:"
  cat "$out"
  exit 1
}

# refuse MESSAGE PROGRAM ARGUMENT...
refuse() {
  message=$1
  shift
  if "$@" >"$out" 2>&1; then
    fail "exit status 0 of $*"
  fi
  [ "$(grep -c -e "$message" "$out")" -eq 1 ] || fail "not one <$message> of $*"
  ! grep -q -e MPI_ABORT -e ORTE_ERROR "$out" || fail "aborted: $*"
}

# accept MESSAGE PROGRAM ARGUMENT...
accept() {
  message=$1
  shift
  "$@" >"$out" 2>&1 || fail "exit status of $*"
  [ "$(grep -c -e "$message" "$out")" -eq 1 ] || fail "not one <$message> of $*"
}

refuse 'There is no parameter file <no_such_file.prm>' "$@" no_such_file.prm
refuse 'The name of the parameter file is empty' "$@" ''
refuse 'is a folder, not a parameter file' "$@" .
refuse 'there is no option <--foo>' "$@" --foo
refuse 'there is no parameter file to run' "$@"
refuse 'takes one parameter file, not 2' "$@" a b
accept 'Usage: ' "$@" --help
accept 'Usage: ' "$@" -h
accept '[0-9]\.[0-9]\.[0-9], deal.II [0-9]' "$@" --version
if [ "$(id -u)" -ne 0 ]; then
  : >unreadable.$$.prm
  chmod 000 unreadable.$$.prm
  refuse 'cannot be read: Permission denied' "$@" unreadable.$$.prm
  rm -f unreadable.$$.prm
fi
