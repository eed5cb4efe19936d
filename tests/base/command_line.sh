#!/bin/bash
# command_line.sh GREVILLE GREVILLE_BENCHMARK: scripts/run asks the program which
# one a file is for, and bash completes command lines. What the programs answer
# is in tests/run/command_line.cc.
greville=$1
benchmark=$2
scripts=$(cd "$(dirname "$0")/../../scripts" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1

fail() {
  echo "FAILED: $*"
  cat out
  exit 1
}

# runs STATUS WORD OPTION...: scripts/run ends with this status and prints this
# once.
runs() {
  status=$1
  word=$2
  shift 2
  sh tree/scripts/run "$@" >out 2>&1
  [ $? -eq "$status" ] || fail "exit status of scripts/run $*"
  [ "$(grep -c -F -e "$word" out)" -eq 1 ] || fail "not one <$word> of scripts/run $*"
}

# Here scripts/run builds nothing.
mkdir -p tree/scripts tree/build
cp "$scripts/run" "$scripts/common.sh" tree/scripts
echo 'install_packages() { :; }; is_configured() { :; }; build() { :; }' >>tree/scripts/common.sh
ln -s "$greville" tree/build/greville
ln -s "$benchmark" tree/build/greville_benchmark
"$greville" --new slope >out || fail "--new slope"
printf 'include slope.prm\n' >included.prm
printf '\357\273\277include included.prm\n' >marked.prm
printf 'subsection Benchmark\nend\n' >benchmark.prm
printf 'include benchmark.prm\n' >other.prm
runs 0 'number of steps: about' --check --set "Grid/Cells=45, 12" marked.prm
runs 0 'running greville_benchmark other.prm' --set Benchmark/Cells=4 --set Benchmark/Orders=2 other.prm
runs 1 'there is no parameter' --set Grid/Odrer=3 slope.prm

# deal.II would end with an assertion.
for program in "$greville" "$benchmark"; do
  DEAL_II_NUM_THREADS=0 "$program" --version >out 2>&1 || fail "no threads"
done

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
}
completes --print-parameters --pr
completes materials --list mat
completes cantilever_3d --new can
completes slope.prm slope.prm --check slo
completes --resume slope.prm --re
completes bash --completion ''
mkdir run_folder
completes run_folder slope.prm --from run_
