// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1 2

// Checks refused files of the base "block" in refusals.txt: wrong names,
// numbers, formulas and texts. Long messages are cut.
#include "refusals.h"

void
test_main()
{
  check_refusals([](const std::string &base) { return base == "block"; });

  const std::string message =
    message_of(ExcMessage("is <" + std::string(100000, 'x') + ">; no"));
  check("the begin of a long message", message.compare(0, 4, "is <") == 0);
  check("its end", message.substr(message.size() - 5) == ">; no");
  check("its length", message.size() < 4000);
}
