// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks the orders of the levels.

#include <greville/spline/order_hierarchy.h>

#include <tests.h>

void
test_main()
{
  Box<2> box(MultiIndex<2>{{4, 8}});
  for (const auto &[coarsening, name] : coarsenings)
    for (unsigned int p = 1; p <= 5; ++p)
      {
        const OrderHierarchy<2> orders(box.mesh, p, coarsening);
        print() << name << ", p = " << p << ":";
        for (unsigned int l = 0; l < orders.n_levels(); ++l)
          print() << " " << orders[l].degree() << " (" << orders[l].n_dofs()
                  << ")";
        print() << std::endl;
      }
  try
    {
      value_of("by three", coarsenings);
    }
  catch (const std::exception &error)
    {
      print() << message_of(error) << std::endl;
    }
}
