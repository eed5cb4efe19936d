// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2

// Checks refused files of all bases but "block" in refusals.txt: several
// bodies, files that cannot be written, runs that fail, contacts, axisymmetry
// and water.
#include "refusals.h"

void
test_main()
{
  check_refusals([](const std::string &base) { return base != "block"; });
}
