#!/bin/sh
# command_line.sh PROJECT [all]: what the scripts answer to help and to wrong
# command lines. Nothing is installed or run, and a UMAT is built without a warning. Only with "all", scripts in
# Python, which begin slowly, meet a wrong option and -h, and each table is asked
# for help.
cd "$1" || exit 1
status=0
out=$(mktemp)
trap 'rm -f "$out" "$out.so"' EXIT

# answers STATUS LINES TEXT COMMAND...: the command ends with this status after
# at most so many lines, one of which has the text.
answers() {
  wanted=$1
  n_lines=$2
  text=$3
  shift 3
  "$@" >"$out" 2>&1 </dev/null
  got=$?
  if [ $got -ne "$wanted" ] || ! grep -qF -- "$text" "$out" ||
    [ "$(wc -l <"$out")" -gt "$n_lines" ]; then
    echo "FAILED: $*: exit status $got, not $wanted, or not '$text' in $n_lines lines:"
    cat "$out"
    status=1
  fi
}

# asks OPTION SCRIPT...
asks() {
  option=$1
  shift
  for script in "$@"; do
    case $option in
      *help | -h) answers 0 40 "sage: scripts/$script" "scripts/$script" "$option" ;;
      *) answers 2 5 "scripts/$script" "scripts/$script" "$option" ;;
    esac
  done
}
for option in -h --help --no-such-option; do
  asks $option run test package fresh_machine sanitize fuzz check_input site
done
python="sweep picture gear kill_and_resume lint faults combinations gallery benchmark check_docs performance paraview points_to_csv report tables notebooks release"
if [ -x /usr/bin/python3 ]; then
  # shellcheck disable=SC2086
  asks --help $python
  if [ "$2" = all ]; then
    # shellcheck disable=SC2086
    asks -h $python
    # shellcheck disable=SC2086
    asks --no-such-option $python
    for name in $(scripts/tables --list | sed 's/ .*//'); do
      answers 0 40 "usage: scripts/tables $name" scripts/tables "$name" --help
    done
  fi
fi
answers 0 1 "$out.so" env FLAGS=-Wmissing-include-dirs \
  scripts/build_umat benchmarks/umat/elastic.f "$out.so"
answers 2 20 "Usage: scripts/run" scripts/run
answers 2 1 "-np takes a number of processes." scripts/run -np
answers 2 1 "not <a.prm>" scripts/run -np a.prm
answers 2 1 "not <0>" scripts/run -np 0 a.prm
answers 2 20 "Usage: scripts/run" scripts/run -np 2
answers 2 1 "there is no parameter file <a.prm>" scripts/run a.prm
answers 2 1 "<prm> is a folder" scripts/run prm
answers 2 1 "has no section of a program" scripts/run README.md
answers 2 1 "takes one parameter file, not both <README.md> and <b.prm>." scripts/run README.md b.prm
answers 2 1 "takes the folder of a run" scripts/run --resume
answers 2 1 "there is no folder <nowhere>" scripts/run --from nowhere README.md
answers 2 1 "uses the parameter file" scripts/run --resume prm README.md
answers 2 1 "--set takes" scripts/run --set
answers 2 1 "--draw goes with --check" scripts/run --draw here prm/simulation/dam_break.prm
answers 2 1 "--draw goes with --check" scripts/run prm/simulation/dam_break.prm --draw here
answers 2 1 "there is no option <--no-such-option>" scripts/run README.md --no-such-option
answers 2 1 "takes one regular expression, but also has <b>." scripts/test a b
answers 2 1 "takes one regular expression, but also has <b>." scripts/sanitize a b
answers 2 1 "not <x>" scripts/fuzz x
answers 2 1 "there is no parser <x>" scripts/fuzz 1 x
answers 2 1 "there is no file <x.cc>" scripts/lint x.cc
answers 2 1 "<prm> has other files." scripts/site prm
answers 2 1 "--tests takes" scripts/fresh_machine --tests
answers 2 1 "--release takes" scripts/fresh_machine --release
answers 2 10 "Usage: .ci/build" .ci/build g++ Fast

# A user who is not root is shown what is missing; sudo is called after a yes, or
# not at all. The programs that install are replaced by ones that say so.
(
  place=$(mktemp -d)
  trap 'rm -rf "$place"' EXIT
  printf '#!/bin/sh\necho 1000\n' >"$place/id"
  printf '#!/bin/sh\necho called: sudo "$@"\n' >"$place/sudo"
  printf '#!/bin/sh\nexit 1\n' >"$place/dpkg-query"
  printf '#!/bin/sh\necho called: apt-get\n' >"$place/apt-get"
  printf '. scripts/common.sh\ninstall_packages soil water\n' >"$place/script"
  chmod +x "$place"/*
  asked() {
    PATH=$place:$PATH sh -e "$place/script" "$@" </dev/null 2>&1
  }
  asked >"$place/out" && exit 1
  grep -q "missing packages: soil water" "$place/out" || exit 1
  grep -q "sudo apt-get install -y --no-install-recommends soil water" \
    "$place/out" || exit 1
  ! grep called "$place/out" || exit 1
  asked --yes >"$place/out" || exit 1
  grep -q "called: sudo env .* apt-get install -y .* soil water" "$place/out" ||
    exit 1
  rm "$place/sudo"
  mkdir "$place/bin"
  for program in sh grep sed nproc dirname basename; do
    ln -s "$(command -v $program)" "$place/bin"
  done
  PATH=$place:$place/bin asked --yes >"$place/out" && exit 1
  grep -q "as root: apt-get install" "$place/out" || exit 1
  rm "$place/apt-get"
  PATH=$place:$place/bin asked >"$place/out" || exit 1
  grep -q "no apt-get here; .*: apt-get install" "$place/out"
) >"$out" 2>&1 || {
  echo "FAILED: the installation of packages:"
  cat "$out"
  status=1
}

# A release of a small tree with the files of this one: tag, archive, packages and
# checksums. A second one, and one of a changed tree, are refused.
(
  command -v git >/dev/null && command -v dpkg-query >/dev/null || exit 0
  place=$(mktemp -d)
  trap 'rm -rf "$place"' EXIT
  for file in CITATION.cff CHANGELOG.md python/pyproject.toml paper/paper.md \
    include/greville/base/plugin.h doc/step-greville/doc/author \
    scripts/release scripts/common.sh; do
    mkdir -p "$place/tree/$(dirname $file)" && cp $file "$place/tree/$file" || exit 1
  done
  cd "$place/tree" || exit 1
  export GIT_CONFIG_GLOBAL="$place/config" GIT_CONFIG_NOSYSTEM=1
  git config --global user.name tester && git config --global user.email tester@example.org
  echo /build-release/ >.gitignore
  git init -q . && git add . && git commit -qm tree && scripts/release || exit 1
  version=$(sed -n 's/^version: //p' CITATION.cff)
  [ "$(git cat-file -t "v$version")" = tag ] || exit 1
  (cd build-release && sha256sum -c SHA256SUMS && grep -q "^PackageName: libdeal.ii-dev" ./*.spdx &&
    tar -tf "greville-$version.tar.gz" | grep -q "^greville-$version/CHANGELOG.md") || exit 1
  scripts/release 2>"$place/out" && exit 1
  grep -q "already a tag v$version" "$place/out" || exit 1
  sed -i 's/^version: .*/version: 99.1.0/' CITATION.cff
  scripts/release 2>"$place/out" && exit 1
  grep -q "not with <## 99.1.0" "$place/out" || exit 1
  sed -i 's/^## [0-9.]*/## 99.1.0/' CHANGELOG.md
  scripts/release 2>"$place/out" && exit 1
  grep -q "commit or remove these files" "$place/out" &&
    grep -q 'PLUGIN_VERSION "99.1.0"' include/greville/base/plugin.h
) >"$out" 2>&1 || {
  echo "FAILED: a release:"
  cat "$out"
  status=1
}

# A build tree of another folder is configured anew, one of this folder is not.
(
  place=$(mktemp -d)
  trap 'rm -rf "$place"' EXIT
  mkdir "$place/original"
  echo 'cmake_minimum_required(VERSION 3.18)
    project(none NONE)' >"$place/original/CMakeLists.txt"
  . scripts/common.sh
  cd "$place/original" || exit 1
  configure build Release && is_configured build || exit 1
  cp -r "$place/original" "$place/copy"
  cd "$place/copy" || exit 1
  ! is_configured build && configure build Release && is_configured build &&
    ! grep -q "$place/original" build/build.ninja
) >"$out" 2>&1 || {
  echo "FAILED: a build tree in a copy of the project:"
  cat "$out"
  status=1
}
exit $status
