// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks the orders of the levels.

#include <greville/spline/order_hierarchy.h>

#include <tests.h>

void
test_main()
{
  Box<2> box(MultiIndex<2>{{4, 8}});
  for (const std::string coarsening :
       {"one by one", "by two", "direct", "none"})
    for (unsigned int p = 1; p <= 5; ++p)
      {
        const OrderHierarchy<2> orders(box.mesh, p, coarsening);
        print() << coarsening << ", p = " << p << ":";
        for (unsigned int l = 0; l < orders.n_levels(); ++l)
          print() << " " << orders[l].degree() << " (" << orders[l].n_dofs()
                  << ")";
        print() << std::endl;
      }
  try
    {
      OrderHierarchy<2>::orders(3, "by three");
    }
  catch (const std::exception &error)
    {
      print() << message_of(error) << std::endl;
    }
}
