// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/benchmark/benchmark_program.h>

int
main(int argc, char **argv)
{
  return greville::run_program(greville::benchmark_program(), argc, argv);
}
