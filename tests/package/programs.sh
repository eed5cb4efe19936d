#!/bin/sh
# programs.sh CMAKE BUILD_TREE STEP MPIEXEC FLAG NUMDIFF: install the build tree,
# build the step program in the folder STEP against what is installed, run it on
# one and on two processes, and compare what it prints with the block @code in
# its results.dox. The same with the program in doc/examples/own_law, whose law is
# one of the library under another name, and with the plugin that has this law.
set -e
cmake=$1
folder=$2/package_test_programs
step=$3
mpiexec=$4
np=$5
numdiff=$6
rm -rf "$folder"
"$cmake" --install "$2" --prefix "$folder/prefix" >/dev/null
if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache
fi
linker=
if command -v ld.lld >/dev/null; then
  linker=-fuse-ld=lld
fi
# build_in FOLDER SOURCE
build_in() {
  "$cmake" -S "$2" -B "$1" -G Ninja \
    -DCMAKE_PREFIX_PATH="$folder/prefix" -DCMAKE_EXE_LINKER_FLAGS=$linker
  "$cmake" --build "$1"
}
law=$step/../examples/own_law
build_in "$folder/build" "$step"
build_in "$folder/build_law" "$law"

# Iterations may differ by two, where processes or round-off do. Other numbers
# have to agree to 0.2 %, or to the last printed digit.
compare() {
  cd "$folder/$1"
  for file in expected printed; do
    sed '/^$/,$d' $file >$file.iterations
    sed '1,/^$/d; s/, [0-9]* linear systems.*//' $file >$file.steps
    [ -s $file.steps ]
  done
  "$numdiff" -a 2 expected.iterations printed.iterations
  "$numdiff" -a 0.011 -r 2e-3 expected.steps printed.steps
  for name in explicit/points explicit/grid implicit/points implicit/grid; do
    [ "$(grep -c "$(basename $name)_[0-9]*.pvtu" $name.pvd)" = 11 ]
  done
}

for n in 1 2; do
  mkdir "$folder/$n"
  cd "$folder/$n"
  sed -n '/^@code/,/^@endcode/{/^@/d;p}' "$step/doc/results.dox" >expected
  "$mpiexec" "$np" $n "$folder/build/step-greville" | sed 's/ *$//' >printed
  cat printed
  compare $n

  # The last time, mass, momenta and energies.
  "$mpiexec" "$np" $n "$folder/build_law/own_law" "$law/sponge.prm"
  sed 's/= sponge$/= neo-hookean/; s/Shear modulus = 50 /Young modulus = 100\nset Poisson ratio = 0/' \
    "$law/sponge.prm" >neo-hookean.prm
  "$mpiexec" "$np" $n "$folder/prefix/bin/greville" neo-hookean.prm \
    --set Output/Directory=output/neo-hookean >/dev/null
  "$mpiexec" "$np" $n "$folder/prefix/bin/greville" "$law/sponge.prm" \
    --set Output/Directory=output/plugin --set \
    "Simulation/Additional shared libraries=$folder/build_law/sponge.so" >/dev/null
  for name in sponge neo-hookean plugin; do
    tail -n 1 output/$name/statistics.csv | cut -d, -f1-8 | tr , ' ' >$name
    [ -s $name ]
    [ "$(grep -c "points_[0-9]*.pvtu" output/$name/points.pvd)" = 3 ]
  done
  "$numdiff" -a 1e-12 -r 1e-8 neo-hookean sponge
  "$numdiff" -a 1e-12 -r 1e-8 plugin sponge
done
