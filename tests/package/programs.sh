#!/bin/sh
# programs.sh BUILD_TREE ROOT MPIEXEC FLAG NUMDIFF: run the commands of
# doc/developer/adding_a_law.md and the one of README.md for the step program, letter
# by letter: they install the build tree and build the step program, the program in
# doc/examples/own_law, and its plugin against what is installed. Then run the step
# program on one and on two processes. The law of own_law is one of the library under
# another name: the same results from the program, from the plugin and from the library.
set -e
folder=$1/package_test_programs
root=$2
mpiexec=$3
np=$4
numdiff=$5
rm -rf "$folder"
mkdir -p "$folder/tree/doc/examples"
cp -r "$root/doc/step-greville" "$folder/tree/doc"
cp -r "$root/doc/examples/own_law" "$folder/tree/doc/examples"
ln -s "$1" "$folder/tree/build"
if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache
fi
if command -v ld.lld >/dev/null; then
  export LDFLAGS=-fuse-ld=lld
fi
HOME=$folder/home
export HOME
sed -n '/^```sh/,/^```/{/^```/d;p}' "$root/doc/developer/adding_a_law.md" >"$folder/commands"
sed -n 's/^Build it by `\(cmake .*\)`; its.*/\1/p' "$root/README.md" >"$folder/step"
[ "$(wc -l <"$folder/commands")" = 4 ] && [ -s "$folder/step" ]
cd "$folder/tree"
sh -ex "$folder/commands"
sh -ex "$folder/step"
cd "$folder"
prefix=$HOME/greville
programs=$folder/tree/output
law=$root/doc/examples/own_law

# The documented commands choose the program's library of deal.II. A plugin that is
# linked with the other one, too, is refused before it is loaded.
deal_ii_of() {
  ldd "$1" | sed -n 's/.*=> \(.*libdeal[^ ]*\) .*/\1/p'
}
library=$(deal_ii_of "$prefix/bin/greville")
[ "$(deal_ii_of "$programs/own_law/sponge.so")" = "$library" ]
debug=$(echo "$library" | sed 's/\.so/.g.so/')
if [ -f "$debug" ]; then
  c++ -shared -Wl,--no-as-needed -o "$folder/both.so" \
    "$programs"/own_law/CMakeFiles/sponge.dir/plugin.cc.o "$library" "$debug"
  ! "$prefix/bin/greville" "$law/sponge.prm" --set \
    "Simulation/Additional shared libraries=$folder/both.so" 2>"$folder/refused" || exit 1
  grep "is linked with <libdeal.*g.so" "$folder/refused"
  [ ! -e output/sponge ]
fi

for n in 1 2; do
  sh "$root/tests/package/step.sh" "$root" "$folder/$n" "$numdiff" \
    "$mpiexec" "$np" $n "$programs/step-greville/step-greville"
  cd "$folder/$n"

  # The last time, mass, momenta and energies.
  "$mpiexec" "$np" $n "$programs/own_law/own_law" "$law/sponge.prm"
  sed 's/= sponge$/= neo-hookean/; s/Shear modulus = 50 /Young modulus = 100\nset Poisson ratio = 0/' \
    "$law/sponge.prm" >neo-hookean.prm
  "$mpiexec" "$np" $n "$prefix/bin/greville" neo-hookean.prm \
    --set Output/Directory=output/neo-hookean >/dev/null
  "$mpiexec" "$np" $n "$prefix/bin/greville" "$law/sponge.prm" \
    --set Output/Directory=output/plugin --set \
    "Simulation/Additional shared libraries=$programs/own_law/sponge.so" >/dev/null
  for name in sponge neo-hookean plugin; do
    tail -n 1 output/$name/statistics.csv | cut -d, -f1-8 | tr , ' ' >$name
    [ -s $name ]
    [ "$(grep -c "points_[0-9]*.vtu" output/$name/fields.pvd)" = 3 ]
  done
  "$numdiff" -a 1e-12 -r 1e-8 neo-hookean sponge
  "$numdiff" -a 1e-12 -r 1e-8 plugin sponge
done
