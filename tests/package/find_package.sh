#!/bin/sh
# find_package.sh CMAKE BUILD_TREE: install the build tree; another project finds
# it, compiles one file, links it against the library, and runs it. It gets none of
# the options by which the library was optimized, and the library's build type; the
# package refuses another one.
set -e
cmake=$1
folder=$2/package_test
rm -rf "$folder"
"$cmake" --install "$2" --prefix "$folder/prefix" >/dev/null
if grep -rE --include='greville*.cmake' -e '-(march|O[0-3]|g0)' "$folder/prefix"; then
  exit 1
fi
cat >"$folder/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.18)
find_package(greville REQUIRED)
deal_ii_initialize_cached_variables()
project(names LANGUAGES CXX)
add_executable(names names.cc)
deal_ii_setup_target(names)
target_link_libraries(names greville::greville)
END
cat >"$folder/names.cc" <<'END'
#include <greville/parameters/names.h>
#include <iostream>

int
main()
{
  std::cout << greville::time_integrator_names() << std::endl;
}
END
if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache
fi
linker=
if command -v ld.lld >/dev/null; then
  linker=-fuse-ld=lld
fi
"$cmake" -S "$folder" -B "$folder/build" -G Ninja \
  -DCMAKE_PREFIX_PATH="$folder/prefix" -DCMAKE_EXE_LINKER_FLAGS=$linker
"$cmake" --build "$folder/build"
"$folder/build/names" >"$folder/out"
grep newmark "$folder/out"
"$folder/prefix/bin/greville" --version

# refuses TYPE OPTION: the package names the type and the one that it has.
refuses() {
  ! "$cmake" -S "$folder" -B "$folder/refused" -G Ninja \
    -DCMAKE_PREFIX_PATH="$folder/prefix" "$2" >"$folder/out" 2>&1 || exit 1
  tr -s '\n ' ' ' <"$folder/out" | grep "CMAKE_BUILD_TYPE is $1, and this installation of Greville has the Release library"
  rm -r "$folder/refused"
}
refuses Debug -DCMAKE_BUILD_TYPE=Debug
refuses RelWithDebInfo -DCMAKE_BUILD_TYPE=RelWithDebInfo
# deal.II's own default, if it is found and asked first.
sed -i 's/^find_package(greville.*/find_package(deal.II REQUIRED HINTS ${DEAL_II_DIR} $ENV{DEAL_II_DIR})/
  s/^project.*/&\nfind_package(greville REQUIRED)/' "$folder/CMakeLists.txt"
refuses Debug -Wno-dev
