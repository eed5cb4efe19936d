#!/bin/sh
# find_package.sh CMAKE BUILD_TREE SOURCE: install the build tree, build a small
# project that uses find_package(greville), and run it: 11 x 7 coefficients.
set -e
cmake=$1
folder=$2/package_test
rm -rf "$folder"
"$cmake" --install "$2" --prefix "$folder/prefix"
"$cmake" -S "$3" -B "$folder/build" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$folder/prefix"
"$cmake" --build "$folder/build"
result=$("$folder/build/ten_lines")
echo "ten_lines printed: $result"
[ "$result" = 77 ]
