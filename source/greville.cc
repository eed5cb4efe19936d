// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/run/simulation_program.h>

#include "forget_threads.h"

int
main(int argc, char **argv)
{
  return greville::run_program(greville::simulation_program(), argc, argv);
}
