#!/bin/bash
# command_line.sh GREVILLE GREVILLE_BENCHMARK: the command lines of both
# programs that run no simulation, or a tiny one.
greville=$1
benchmark=$2
scripts=$(cd "$(dirname "$0")/../../scripts" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
n=0

fail() {
  echo "FAILED: $*"
  cat out
  exit 1
}

# accept [WORD...] -- COMMAND...: it ends well and prints all of these.
accept() {
  words=()
  while [ "$1" != -- ]; do
    words+=("$1")
    shift
  done
  shift
  "$@" >out 2>&1 || fail "exit status of $*"
  for word in "${words[@]}"; do
    grep -q -F -e "$word" out || fail "no <$word> of $*"
  done
  n=$((n + 1))
}

# refuse MESSAGE COMMAND...: it ends with 1, and prints this once.
refuse() {
  message=$1
  shift
  "$@" >out 2>&1 && fail "exit status 0 of $*"
  [ "$(grep -c -F -e "$message" out)" -eq 1 ] || fail "not one <$message> of $*"
  n=$((n + 1))
}

for program in "$greville" "$benchmark"; do
  accept Usage: --set --print-parameters --list --completion --version -- "$program" --help
  [ "$(wc -l <out)" -le 45 ] || fail "the help is longer than a page"
  [ "$(wc -L <out)" -le 80 ] || fail "the help has long lines"
  refuse 'there is no option <--pritn-parameters>. Did you mean <--print-parameters>?' "$program" --pritn-parameters
  refuse 'the option <--help> takes no value' "$program" --help=me
  refuse 'needs a value: "SECTION/PARAMETER=VALUE"' "$program" a.prm --set
  refuse '--parameters takes no file' "$program" --parameters a.prm
  refuse '--list and --parameters exclude each other' "$program" --parameters --list
  refuse '--set is for a parameter file' "$program" --list --set A/B=1
  refuse '--completion knows the shell bash, not <zsh>' "$program" --completion zsh
  accept smoothers -- "$program" --list
  accept ic0 jacobi -- "$program" --list smoothers
  refuse 'there is no list <smother>. Did you mean <smoothers>?' "$program" --list smother
done

# Lists come from the program itself.
accept linear-elastic mohr-coulomb newtonian-fluid -- "$greville" --list materials
accept box level_set difference -- "$greville" --list shapes
accept auto consistent lumped fmpm-K -- "$greville" --list masses
accept sliding friction periodic -- "$greville" --list walls
accept USL newmark -- "$greville" --list integrators
accept Order 'Lower corner' -- "$greville" --list Grid
accept 'default: 2' 'a whole number between 1 and' -- "$greville" --list Grid/Order
refuse 'it is no section, and no parameter' "$greville" --list nothing

# Templates: each is a file that runs, and no file is written over.
accept 'slope ' 'cantilever_3d ' 'A slope of soil' 'under an end load that grows to 100 N' -- "$greville" --new
templates=$("$greville" --new | sed 's/ .*//')
for template in $templates; do
  accept "Written: $template.prm" -- "$greville" --new "$template"
  [ -s "$template.prm" ] || fail "no file of $template"
  accept -- "$greville" "$template.prm" --print-parameters
done
echo mine >mine.prm
refuse 'There is a file <mine.prm> already' "$greville" --new slope mine.prm
[ "$(cat mine.prm)" = mine ] || fail "mine.prm has been written over"
accept 'Written: other.prm' -- "$greville" --new slope other.prm
cmp other.prm slope.prm >out || fail "other.prm is not the template"
refuse 'there is no template <slpoe>' "$greville" --new slpoe
refuse 'there is no option <--new>' "$benchmark" --new

# All parameters, the defaults and those of a file, run as they are.
"$greville" --print-parameters >all.prm || fail "--print-parameters"
accept '3 steps' -- "$greville" all.prm --set "Time/Maximum steps=3" --set=Grid/Order=1
grep -q 'set Order *= 1' output/defaults/parameters.prm || fail "the setting is not in parameters.prm"
accept 'set Order        = 3' -- "$greville" slope.prm --print-parameters --set Grid/Order=3
refuse 'The option --set <Grid/Odrer=3>: in the section' "$greville" slope.prm --set Grid/Odrer=3
refuse 'The option --set <Grid/Order=9>: the parameter' "$greville" slope.prm --check --set Grid/Order=9
# JSON and XML lead to the same values, with stages as well.
for template in slope quasi_static_cut; do
  "$greville" "$template.prm" --print-parameters >first.prm
  for format in json xml; do
    "$greville" "$template.prm" --print-parameters $format >"$template.$format" || fail "--print-parameters $format"
    accept -- "$greville" "$template.$format" --print-parameters
    cmp first.prm out || fail "$template.$format has other values"
    rm "$template.$format"
  done
done
accept '"Order": 3,' -- "$greville" --print-parameters json slope.prm --set Grid/Order=3
accept '<Upper_20corner>' -- "$greville" --print-parameters=xml
accept '<Solvers>' -- "$benchmark" --print-parameters xml
refuse 'takes one of prm|json|xml, not <yaml>' "$greville" slope.prm --print-parameters=yaml
echo '{"Grid": {"Odrer": 3}, "Simulation": {"Bodies": "a"}, "Body a": {"Shape": "none"}}' >wrong.json
refuse "<wrong.json>: in the section 'Grid' there is no parameter 'Odrer'. Did you mean <Order>?" "$greville" wrong.json
refuse '--draw is for the initial state' "$greville" slope.prm --draw here
refuse 'is given twice' "$greville" slope.prm --check --check
refuse '--resume and --from exclude each other' "$greville" slope.prm --resume --from there

# A check writes nothing.
rm -rf output
accept 'number of steps: about' 'estimated time: ' 'memory: ' -- \
  "$greville" slope.prm --check --set "Grid/Cells=45, 12"
[ ! -e output ] || fail "--check has written results"
# Numbers that look like those in other units.
accept 's waves, m/s' ' 2000 ' ' 82.0' ' 43.8' ' 751' -- "$greville" slope.prm --check
accept 'density of 20 kg' -- "$greville" slope.prm --check --set "Material soil/Density=20"
accept "'Material soil' is soft" -- "$greville" slope.prm --check --set "Material soil/Young modulus=1e4"
accept "'Material soil' is weak" -- "$greville" slope.prm --check --set "Material soil/Cohesion=8"
"$greville" slope.prm --check | grep -q Note: && fail "a note on usual numbers"

# Element tests of a material, without a run.
accept 'Element test triaxial-drained of soil' 'largest q' 'results: tested/element_test.csv' -- \
  "$greville" slope.prm --element-test triaxial-drained --material soil --set Output/Directory=tested \
  --set "Element test/Steps=7" --set "Element test/Strain=0.1, 0.05"
[ "$(wc -l <tested/element_test.csv)" -eq 16 ] || fail "rows of tested/element_test.csv"
head -1 tested/element_test.csv >out
grep -q '^strain_axial,strain_volumetric,strain_shear,p,q,void_ratio,pore_pressure,.*plastic_strain' out ||
  fail "columns of tested/element_test.csv"
accept -- "$greville" slope.prm --element-test simple-shear --set Output/Directory=tested
[ -f tested/earlier_1/element_test.csv ] || fail "the earlier element test has not been moved"
accept triaxial-undrained -- "$greville" --list element-tests
refuse 'there is no material <sol> in <slope.prm>, which has: soil. Did you mean <soil>?' \
  "$greville" slope.prm --element-test oedometer --material sol
refuse "it has to be one of isotropic|oedometer" "$greville" slope.prm --element-test odometer
refuse '--material is for --element-test' "$greville" slope.prm --material soil
refuse 'it goes without --check' "$greville" slope.prm --element-test oedometer --check

"$benchmark" --print-parameters >benchmark.prm || fail "--print-parameters of $benchmark"
accept -- "$benchmark" benchmark.prm --set Benchmark/Cells=4 --set Benchmark/Orders=2 \
  --set "Benchmark/Output directory=solved"
grep -q 'set Orders *= 2' solved/parameters.prm || fail "the setting is not in parameters.prm"

# scripts/run asks the program which one a file is for. Here it builds nothing.
mkdir -p tree/scripts tree/build
cp "$scripts/run" "$scripts/common.sh" tree/scripts
echo 'install_packages() { :; }; is_configured() { :; }; build() { :; }' >>tree/scripts/common.sh
ln -s "$greville" tree/build/greville
ln -s "$benchmark" tree/build/greville_benchmark
printf 'include slope.prm\n' >included.prm
printf '\357\273\277' | cat - slope.prm >marked.prm
printf 'include benchmark.prm\n' >other.prm
for file in included.prm marked.prm; do
  accept 'number of steps: about' -- sh tree/scripts/run --check --set "Grid/Cells=45, 12" $file
done
accept 'running greville_benchmark other.prm' -- sh tree/scripts/run \
  --set Benchmark/Cells=4 --set Benchmark/Orders=2 other.prm
refuse 'there is no parameter' sh tree/scripts/run --set Grid/Odrer=3 slope.prm

# bash completes options, lists, templates and files.
"$greville" --completion bash >completion || fail "--completion"
. ./completion
complete -p greville >out || fail "nothing is completed"
completes() {
  wanted=$1
  shift
  COMP_WORDS=(greville "$@")
  COMP_CWORD=$#
  COMPREPLY=()
  _greville
  echo "${COMPREPLY[*]}" >out
  [ "${COMPREPLY[*]}" = "$wanted" ] || fail "completion of $*: not <$wanted>"
  n=$((n + 1))
}
completes --print-parameters --pr
completes materials --list mat
completes cantilever_3d --new can
completes slope.prm slope.prm --check slo
completes --resume slope.prm --re
completes bash --completion ''
mkdir run_folder
completes run_folder slope.prm --from run_

[ "$n" -gt 60 ] || fail "only $n cases"
echo "$n cases"
