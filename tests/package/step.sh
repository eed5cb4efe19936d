#!/bin/sh
# step.sh ROOT FOLDER NUMDIFF COMMAND...: run the step program by COMMAND in the new
# folder FOLDER, and compare what it prints with the block @code in its results.dox.
# Iterations may differ by two, where processes or round-off do. Other numbers have to
# agree to 0.2 %, or to the last printed digit.
set -e
results=$1/doc/step-greville/doc/results.dox
folder=$2
numdiff=$3
shift 3

rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
sed -n '/^@code/,/^@endcode/{/^@/d;p}' "$results" >expected
"$@" >lines
sed 's/ *$//' lines | tee printed
for file in expected printed; do
  sed '/^$/,$d' $file >$file.iterations
  sed '1,/^$/d; s/, [0-9]* linear systems.*//' $file >$file.steps
  [ -s $file.steps ]
done
"$numdiff" -a 2 expected.iterations printed.iterations
"$numdiff" -a 0.011 -r 2e-3 expected.steps printed.steps
for scheme in explicit implicit; do
  for name in points grid; do
    [ "$(grep -c "files/${name}_[0-9]*.vtu" $scheme/fields.pvd)" = 11 ]
  done
done
