#!/bin/sh
# Usage: compare.sh NUMDIFF EXPECTED FOLDER COMMAND...
#
# Run COMMAND in the new folder FOLDER, and compare what it prints with the file
# EXPECTED. Numbers may differ by 1e-6, or by a fraction of 1e-8.
numdiff=$1
expected=$2
folder=$3
shift 3

rm -rf "$folder"
mkdir -p "$folder" && cd "$folder" || exit 1
status=0
"$@" >output 2>&1 || status=$?
if ! "$numdiff" -a 1e-6 -r 1e-8 -s ' \t\n:<>=,;' "$expected" output >difference; then
  head -n 100 difference
  echo "The output is $folder/output; what is expected is $expected."
  exit 1
fi
[ $status -eq 0 ] || echo "exit status $status"
exit $status
