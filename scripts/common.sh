# Shared by scripts/run, scripts/test and others; source it from the project's
# root. Installs missing packages, configures and builds.

packages="cmake g++ ninja-build ccache libdeal.ii-dev openmpi-bin"
drawing_packages="python3-matplotlib python3-vtk9 python3-pil"
test_packages="numdiff gfortran lld doxygen python3-numpy python3-yaml python3-sympy python3-nbclient python3-ipykernel $drawing_packages"
site_packages="mkdocs-material doxygen graphviz libjs-mathjax"
checking_packages="clang clang-tidy libclang-rt-dev valgrind gcc"

# Without these, ccache does not use its cache with precompiled headers. The
# other settings let clones of the project share the cache.
export CCACHE_SLOPPINESS="${CCACHE_SLOPPINESS:-pch_defines,time_macros,include_file_mtime,include_file_ctime}"

# Compilers and tests at a time. nproc counts at most OMP_NUM_THREADS.
JOBS=${JOBS:-$(unset OMP_NUM_THREADS; nproc)}

say() {
  echo "== $*"
}

# usage: print the comment at the top of the running script.
usage() {
  sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$0"
}

# wrong_usage MESSAGE...: print one message, and exit with status 2.
wrong_usage() {
  echo "$(basename "$(dirname "$0")")/$(basename "$0"): $*" >&2
  exit 2
}

# --yes, an option of all these scripts: install packages without asking. Remove
# it from their arguments here.
assume_yes=false
for argument; do
  shift
  case $argument in
    --yes) assume_yes=true ;;
    *) set -- "$@" "$argument" ;;
  esac
done

# Install missing Debian packages. Debian 13's deal.II also needs a linker,
# which its package only recommends.
install_packages() {
  install_missing "$@" || return 1
  if dpkg -L libdeal.ii-dev 2>/dev/null | grep '[.]cmake$' |
    xargs -r grep -qs -e -fuse-ld=mold; then
    install_missing mold
  fi
}

install_missing() {
  missing=""
  for package in "$@"; do
    if ! dpkg-query -W -f='${Status}' "$package" 2>/dev/null |
      grep -q "install ok installed"; then
      missing="$missing $package"
    fi
  done
  [ -z "$missing" ] && return 0
  install="apt-get install -y --no-install-recommends$missing"
  as_root=""
  if [ "$(id -u)" -ne 0 ]; then
    as_root="sudo"
  fi
  say "missing packages:$missing"
  if ! command -v apt-get >/dev/null; then
    say "there is no apt-get here; what it would do on Debian: $install"
    return 0
  fi
  if [ -n "$as_root" ] && ! command -v sudo >/dev/null; then
    say "install them as root: $install"
    return 1
  fi
  if [ -n "$as_root" ] && ! $assume_yes; then
    answer=""
    if [ -t 0 ]; then
      printf '== install them by sudo %s? [y/N] ' "$install"
      read -r answer || true
    fi
    case $answer in
      [yY]*) assume_yes=true ;;
      *)
        say "nothing is installed; --yes installs without a question, or copy:" \
          "sudo $install"
        return 1
        ;;
    esac
  fi
  $as_root apt-get update
  # shellcheck disable=SC2086
  $as_root env DEBIAN_FRONTEND=noninteractive $install
}

# is_configured FOLDER: true for a build tree of this project. In a copied or
# moved project, the tree still has the original paths and would build the
# sources there.
is_configured() {
  home=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$1/CMakeCache.txt" 2>/dev/null)
  [ -f "$1/build.ninja" ] && [ "$home" -ef . ]
}

# configure FOLDER TYPE [OPTION...]
configure() {
  folder=$1
  type=$2
  shift 2
  if [ -f "$folder/CMakeCache.txt" ] && ! is_configured "$folder"; then
    rm -rf "$folder/CMakeCache.txt" "$folder/CMakeFiles" "$folder"/.ninja_* \
      "$folder/build.ninja"
  fi
  say "configuring $folder ($type)"
  mkdir -p "$folder"
  cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE="$type" "$@" \
    >"$folder/configure.log" 2>&1 || {
    cat "$folder/configure.log"
    return 1
  }
}

# configure_clang: configure the tree of scripts/fuzz and scripts/lint.
configure_clang() {
  configure build-clang Debug -DCMAKE_CXX_COMPILER=clang++ \
    -DGREVILLE_SANITIZE=address,undefined -DGREVILLE_TESTS=ON \
    -DCMAKE_EXPORT_COMPILE_COMMANDS=ON
}

# test_targets FOLDER REGEX: print the targets PART.NAME of matching tests with
# a program, and the two programs of the project.
test_targets() {
  echo greville greville_benchmark
  ctest --test-dir "$1" -N -R "$2" | sed -n 's/^ *Test *#[0-9]*: //p' |
    sed 's/[.].*//' | sort -u | while read -r name; do
    if [ -x "$1/tests/$name" ]; then
      echo "$name" | tr / .
    fi
  done
}

# build FOLDER TARGET...: build outdated targets.
build() {
  folder=$1
  shift
  say "building $folder"
  cmake --build "$folder" -j "$JOBS" --target "$@"
}

# Open MPI needs two variables to run as root, and one to run more processes
# than cores. Open MPI 5 has its own names (PRTE_).
set_up_mpi() {
  if [ "$(id -u)" -eq 0 ]; then
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
  fi
  export OMPI_MCA_rmaps_base_oversubscribe=1
  export PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe
  export OMPI_MCA_mpi_yield_when_idle=1
  # Simultaneous runs must not be bound to the same core.
  export OMPI_MCA_hwloc_base_binding_policy=none
  export PRTE_MCA_hwloc_default_binding_policy=none
  export OMP_NUM_THREADS=1 DEAL_II_NUM_THREADS=1
  # Use large pages and keep freed memory, if the kernel allows it
  # (doc/results/simulation.md).
  export GLIBC_TUNABLES="${GLIBC_TUNABLES-glibc.malloc.hugetlb=1:\
glibc.malloc.mmap_threshold=4294967296:glibc.malloc.trim_threshold=8589934592:\
glibc.malloc.top_pad=67108864}"
}
