// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/base/index_set.h>
#include <deal.II/base/mpi.h>

#include <greville/steps/trial_contacts.h>

namespace greville
{
  using namespace dealii;

  template <int dim>
  void
  TrialContacts<dim>::initialize_rigid(VectorType &q) const
  {
    IndexSet owned(n_rigid_unknowns());
    if (Utilities::MPI::this_mpi_process(contacts.comm) == 0)
      owned.add_range(0, n_rigid_unknowns());
    q.reinit(owned, contacts.comm);
    std::vector<typename RigidTrial<dim>::Vector> guesses;
    for (const FreeBody &body : free_bodies)
      guesses.push_back(body.trial.guess());
    set_all(q, guesses);
  }



  template <int dim>
  std::vector<typename RigidTrial<dim>::Vector>
  TrialContacts<dim>::all_of(const VectorType &q) const
  {
    std::vector<double> values(q.begin(), q.end());
    values = Utilities::MPI::broadcast(contacts.comm, values);
    std::vector<typename RigidTrial<dim>::Vector> result(free_bodies.size());
    for (unsigned int i = 0; i < values.size(); ++i)
      result[i / RigidTrial<dim>::n_unknowns][i % RigidTrial<dim>::n_unknowns] =
        values[i];
    return result;
  }



  template <int dim>
  void
  TrialContacts<dim>::set_all(
    VectorType                                          &q,
    const std::vector<typename RigidTrial<dim>::Vector> &values) const
  {
    for (unsigned int i = 0; i < q.locally_owned_size(); ++i)
      q.local_element(i) = values[i / RigidTrial<dim>::n_unknowns]
                                 [i % RigidTrial<dim>::n_unknowns];
  }



  template <int dim>
  void
  TrialContacts<dim>::set_rigid(const VectorType &q)
  {
    const auto all = all_of(q);
    for (unsigned int b = 0; b < free_bodies.size(); ++b)
      {
        FreeBody &body        = free_bodies[b];
        body.q                = all[b];
        at_trial[body.number] = body.trial.position(body.q, share);
        at_end[body.number]   = body.trial.position(body.q, 1.);
      }
  }



  template <int dim>
  void
  TrialContacts<dim>::find_rigid_residual(VectorType &r)
  {
    largest_rigid_force = 0.;
    std::vector<typename RigidTrial<dim>::Vector> residuals;
    for (FreeBody &body : free_bodies)
      {
        Tensor<1, dim>      force;
        RotationVector<dim> moment;
        for (unsigned int c = 0; c < results.size(); ++c)
          if (contacts.contacts[c].rigid == int(body.number))
            {
              force -= results[c].force;
              moment -= results[c].moment;
            }
        body.load = body.trial.load(force, moment);
        residuals.push_back(body.trial.residual(body.q, body.load));
        largest_rigid_force =
          std::max(largest_rigid_force, body.trial.scale(body.load));
      }
    set_all(r, residuals);
  }



  template <int dim>
  Tensor<1, dim>
  TrialContacts<dim>::distance(const FreeBody &body, const Point<dim> &x) const
  {
    const RigidPosition<dim> &now = at_trial[body.number];
    return x - current_position(now, now.reference);
  }



  template <int dim>
  typename RigidTrial<dim>::Vector
  TrialContacts<dim>::load_by_changes(const FreeBody &body) const
  {
    typename RigidTrial<dim>::Vector sum;
    for (unsigned int c = 0; c < tangents.size(); ++c)
      if (contacts.contacts[c].rigid == int(body.number))
        for (std::size_t s = 0; s < points[c].size(); ++s)
          sum -= weight * body.trial.load_at(distance(body, points[c][s].x),
                                             changes[c][s]);
    const ArrayView<double> values(sum.begin_raw(), sum.dimension);
    Utilities::MPI::sum(ArrayView<const double>(values), contacts.comm, values);
    return sum;
  }



  template <int dim>
  void
  TrialContacts<dim>::find_rigid_tangents()
  {
    constexpr unsigned int n = RigidTrial<dim>::n_unknowns;
    for (FreeBody &body : free_bodies)
      {
        const auto inertia = body.trial.stiffness();
        body.inverse.reinit(n, n);
        for (unsigned int j = 0; j < n; ++j)
          {
            typename RigidTrial<dim>::Vector unit;
            unit[j] = 1.;
            for (unsigned int c = 0; c < tangents.size(); ++c)
              if (contacts.contacts[c].rigid == int(body.number))
                {
                  relative[c].resize(points[c].size());
                  for (std::size_t s = 0; s < points[c].size(); ++s)
                    relative[c][s] =
                      -share *
                      body.trial.motion_at(distance(body, points[c][s].x),
                                           unit);
                  tangents[c].multiply(relative[c], changes[c]);
                }
            const auto column = inertia * unit - load_by_changes(body);
            for (unsigned int i = 0; i < n; ++i)
              body.inverse(i, j) = column[i];
          }
        body.inverse.gauss_jordan();
      }
  }



  template <int dim>
  void
  TrialContacts<dim>::precondition_rigid(VectorType       &dst,
                                         const VectorType &src) const
  {
    constexpr unsigned int n = RigidTrial<dim>::n_unknowns;
    for (unsigned int i = 0; i < src.locally_owned_size(); ++i)
      {
        double sum = 0.;
        for (unsigned int j = 0; j < n; ++j)
          sum += free_bodies[i / n].inverse(i % n, j) *
                 src.local_element(i / n * n + j);
        dst.local_element(i) = sum;
      }
  }



  GREVILLE_INSTANTIATE_CLASS(TrialContacts);
} // namespace greville
