#include <deal.II/lac/lapack_full_matrix.h>

#include <greville/base/errors.h>
#include <greville/multigrid/schwarz.h>

#include <map>

namespace greville
{
  using namespace dealii;

  template <int dim>
  struct BoxSchwarz<dim>::Box
  {
    std::vector<unsigned int> entries; // places in the domain
    std::vector<double>       is_own;  // 1: in the box without its overlap
    LAPACKFullMatrix<double>  inverse;
  };



  template <int dim>
  BoxSchwarz<dim>::~BoxSchwarz() = default;



  template <int dim>
  BoxSchwarz<dim>::BoxSchwarz(std::unique_ptr<const OverlappingDomain<dim>> d,
                              const MassMatrix<dim>   &matrix,
                              const unsigned int       box_size,
                              const unsigned int       overlap,
                              const SchwarzCombination c)
    : domain(std::move(d))
    , combination(c)
    , weights(domain->size(), 0.)
    , local(domain->size())
    , sum(domain->size())
  {
    const auto     &extents = matrix.space().n_functions();
    MultiIndex<dim> n_boxes;
    for (unsigned int e = 0; e < dim; ++e)
      n_boxes[e] = (extents[e] + box_size - 1) / box_size;

    // Own entries make the boxes; all entries within reach of a box join it.
    std::map<std::uint64_t, unsigned int> box_at;
    const auto box_index = [&](const MultiIndex<dim> &index) {
      MultiIndex<dim> box;
      for (unsigned int e = 0; e < dim; ++e)
        box[e] = index[e] / box_size;
      return box;
    };
    for (unsigned int i = 0; i < domain->size(); ++i)
      if (domain->owns(i))
        box_at.emplace(lexicographic<dim>(box_index(multi_index<dim>(
                                            domain->positions()[i], extents)),
                                          n_boxes),
                       box_at.size());
    boxes.resize(box_at.size());

    for (unsigned int i = 0; i < domain->size(); ++i)
      {
        const auto index = multi_index<dim>(domain->positions()[i], extents);
        MultiIndex<dim> begin, length;
        for (unsigned int e = 0; e < dim; ++e)
          {
            begin[e] = (index[e] - std::min(index[e], overlap)) / box_size;
            length[e] =
              std::min((index[e] + overlap) / box_size, n_boxes[e] - 1) -
              begin[e] + 1;
          }
        unsigned int n = 1;
        for (unsigned int e = 0; e < dim; ++e)
          n *= length[e];
        for (unsigned int k = 0; k < n; ++k)
          {
            auto box = multi_index<dim>(k, length);
            for (unsigned int e = 0; e < dim; ++e)
              box[e] += begin[e];
            const auto found = box_at.find(lexicographic<dim>(box, n_boxes));
            if (found != box_at.end())
              {
                Box &target = boxes[found->second];
                target.entries.push_back(i);
                target.is_own.push_back(box == box_index(index) ? 1. : 0.);
                weights[i] += 1.;
              }
          }
      }
    for (double &weight : weights)
      weight = weight > 0 ? 1. / std::sqrt(weight) : 0.;

    run_on_all(
      [&]() {
        std::vector<int> place(domain->size(), -1);
        for (Box &box : boxes)
          {
            const unsigned int n = box.entries.size();
            for (unsigned int k = 0; k < n; ++k)
              place[box.entries[k]] = k;
            box.inverse.reinit(n);
            for (unsigned int k = 0; k < n; ++k)
              {
                PetscInt           n_columns;
                const PetscInt    *columns;
                const PetscScalar *values;
                check_petsc(MatGetRow(domain->matrix(),
                                      box.entries[k],
                                      &n_columns,
                                      &columns,
                                      &values));
                for (PetscInt j = 0; j < n_columns; ++j)
                  if (place[columns[j]] >= 0)
                    box.inverse(k, place[columns[j]]) = values[j];
                check_petsc(MatRestoreRow(domain->matrix(),
                                          box.entries[k],
                                          &n_columns,
                                          &columns,
                                          &values));
              }
            for (unsigned int k = 0; k < n; ++k)
              place[box.entries[k]] = -1;
            box.inverse.set_property(LAPACKSupport::symmetric);
            box.inverse.compute_cholesky_factorization();
          }
      },
      domain->communicator());
  }



  template <int dim>
  void
  BoxSchwarz<dim>::apply(VectorType       &dst,
                         const VectorType &src,
                         const bool        transpose) const
  {
    const bool is_symmetric = combination == SchwarzCombination::symmetric;
    domain->restrict_to(local, src, transpose);
    std::fill(sum.begin(), sum.end(), 0.);
    Vector<double> values;
    for (const Box &box : boxes)
      {
        const unsigned int n = box.entries.size();
        values.reinit(n, true);
        for (unsigned int k = 0; k < n; ++k)
          {
            const unsigned int i = box.entries[k];
            values(k)            = local[i] * (is_symmetric ? weights[i]
                                               : transpose  ? box.is_own[k]
                                                            : 1.);
          }
        box.inverse.solve(values);
        for (unsigned int k = 0; k < n; ++k)
          {
            const unsigned int i = box.entries[k];
            sum[i] += values(k) * (is_symmetric ? weights[i]
                                   : transpose  ? 1.
                                                : box.is_own[k]);
          }
      }
    domain->prolongate_from(sum, dst, transpose);
  }



  template <int dim>
  void
  BoxSchwarz<dim>::vmult(VectorType &dst, const VectorType &src) const
  {
    apply(dst, src, false);
  }



  template <int dim>
  void
  BoxSchwarz<dim>::Tvmult(VectorType &dst, const VectorType &src) const
  {
    apply(dst, src, true);
  }



  template <int dim>
  std::size_t
  BoxSchwarz<dim>::memory_consumption() const
  {
    std::size_t n = domain->memory_consumption();
    for (const Box &box : boxes)
      n += box.entries.size() * (box.entries.size() + 2) * sizeof(double);
    return n;
  }



  template class BoxSchwarz<2>;
  template class BoxSchwarz<3>;
} // namespace greville
