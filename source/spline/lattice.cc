// SPDX-License-Identifier: LGPL-2.1-or-later

#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/manifold.h>

#include <greville/base/errors.h>
#include <greville/spline/coarse_cells.h>

#include <cmath>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Refines cells at given edges: a new vertex lies at the mean of the
    /// places of the old ones in units of cells.
    template <int dim>
    class EdgeManifold : public Manifold<dim>
    {
    public:
      EdgeManifold(const std::shared_ptr<const CellEdges<dim>>     &edges,
                   const std::shared_ptr<const CellHierarchy<dim>> &levels)
        : edges(edges)
        , levels(levels)
      {}

      std::unique_ptr<Manifold<dim>>
      clone() const override
      {
        return std::make_unique<EdgeManifold>(edges, levels);
      }

      Point<dim>
      get_new_point(const ArrayView<const Point<dim>> &points,
                    const ArrayView<const double>     &weights) const override
      {
        Point<dim> result;
        for (unsigned int d = 0; d < dim; ++d)
          {
            const std::vector<double> &given = (*edges)[d];
            double                     place = 0.;
            for (unsigned int k = 0; k < points.size(); ++k)
              place +=
                weights[k] *
                (given.empty() ? points[k][d] : edge_at(given, points[k][d]));
            result[d] = given.empty() ? place : given[std::lround(place)];
          }
        return result;
      }

      const std::shared_ptr<const CellEdges<dim>>     edges; // finest ones
      const std::shared_ptr<const CellHierarchy<dim>> levels;

    private:
      /// Return the number of the edge that is nearest to a vertex.
      static unsigned int
      edge_at(const std::vector<double> &edges, const double x)
      {
        const auto next =
          std::upper_bound(edges.begin() + 1, edges.end() - 1, x);
        return next - edges.begin() - (x - next[-1] < next[0] - x ? 1 : 0);
      }
    };
  } // namespace



  template <int dim>
  const std::vector<double> Lattice<dim>::no_edges;



  template <int dim>
  Lattice<dim>::Lattice(const Point<dim> &lower, const Tensor<1, dim> &size)
    : lower_corner(lower)
    , upper_corner(lower + size)
    , sizes(size)
  {
    cells.fill(1);
  }



  template <int dim>
  Lattice<dim>::Lattice(const DistributedTriangulation<dim> &triangulation)
  {
    const MPI_Comm           comm = get_communicator(triangulation);
    const types::manifold_id id   = triangulation.begin(0)->manifold_id();
    if (id != numbers::flat_manifold_id)
      if (const auto *manifold = dynamic_cast<const EdgeManifold<dim> *>(
            &triangulation.get_manifold(id)))
        {
          levels    = manifold->levels;
          all_edges = levels ? levels->edges() : manifold->edges;
        }

    // Smallest and largest corners and cell sizes, with signs such that one
    // reduction suffices.
    const double        infinity = std::numeric_limits<double>::max();
    std::vector<double> local(4 * dim, infinity), global(4 * dim);
    for (const auto &cell : triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        for (unsigned int d = 0; d < dim; ++d)
          {
            const double a = cell->vertex(0)[d];
            const double b =
              cell->vertex(GeometryInfo<dim>::vertices_per_cell - 1)[d];
            local[d]           = std::min(local[d], a);
            local[dim + d]     = std::min(local[dim + d], -b);
            local[2 * dim + d] = std::min(local[2 * dim + d], b - a);
            local[3 * dim + d] = std::min(local[3 * dim + d], a - b);
          }
    Utilities::MPI::min(local, comm, global);

    double product = 1;
    for (unsigned int d = 0; d < dim; ++d)
      {
        lower_corner[d] = edges(d).empty() ? global[d] : edges(d).front();
        upper_corner[d] = edges(d).empty() ? -global[dim + d] : edges(d).back();
        const double size = global[2 * dim + d];
        Require(size > 0 && (!edges(d).empty() ||
                             -global[3 * dim + d] - size <= 1e-6 * size),
                "A spline space needs a mesh whose cells are all boxes of the "
                "same size, or a mesh by create_box_mesh().");
        cells[d] = edges(d).empty()
                     ? std::lround((upper_corner[d] - lower_corner[d]) / size)
                     : edges(d).size() - 1;
        product *= cells[d];
      }
    Require(levels || product == static_cast<double>(
                                   triangulation.n_global_active_cells()),
            "A spline space needs a mesh whose cells fill a box.");
    if (!levels)
      set_sizes();
    else
      {
        // Lattices of levels without active cells have smaller cells.
        for (unsigned int d = 0; d < dim; ++d)
          sizes[d] = global[2 * dim + d];
        run_on_all(comm, [&]() {
          for (const auto &cell : triangulation.active_cell_iterators())
            Require(!cell->is_locally_owned() ||
                      std::abs(cell->extent_in_direction(0) -
                               box(find_cell(cell->center())).size[0]) <
                        1e-6 * sizes[0],
                    "The mesh is not refined as its levels require.");
        });
      }

    // The faces of coarse cells are known on all processes.
    for (const auto &pair : triangulation.get_periodic_face_map())
      periodic[pair.first.second / 2] = true;
  }



  template <int dim>
  void
  Lattice<dim>::set_sizes()
  {
    for (unsigned int d = 0; d < dim; ++d)
      {
        sizes[d] = edges(d).empty()
                     ? (upper_corner[d] - lower_corner[d]) / cells[d]
                     : cell_size(d, 0);
        for (unsigned int cell = 0; cell + 1 < edges(d).size(); ++cell)
          sizes[d] = std::min(sizes[d], cell_size(d, cell));
      }
  }



  template <int dim>
  double
  Lattice<dim>::largest_cell_size(const unsigned int d) const
  {
    double h = sizes[d];
    for (unsigned int cell = 0; cell + 1 < edges(d).size(); ++cell)
      h = std::max(h, cell_size(d, cell));
    return h;
  }



  template <int dim>
  double
  Lattice<dim>::place_between(const std::vector<double> &edges, const double x)
  {
    const auto next = std::upper_bound(edges.begin() + 1, edges.end() - 1, x);
    return double(next - edges.begin() - 1) +
           (x - next[-1]) / (next[0] - next[-1]);
  }



  template <int dim>
  Lattice<dim>
  Lattice<dim>::parents() const
  {
    Require(!levels, "The cells of a refined mesh have no parents.");
    Lattice result = *this;
    for (unsigned int d = 0; d < dim; ++d)
      {
        Require(cells[d] % 2 == 0,
                "Cells join in pairs only if their number is even in all "
                "directions; it is " +
                  std::to_string(cells[d]) + " in " + std::string(1, "xyz"[d]) +
                  ".");
        result.cells[d] /= 2;
      }
    if (all_edges)
      {
        CellEdges<dim> every_second;
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int k = 0; k < edges(d).size(); k += 2)
            every_second[d].push_back(edges(d)[k]);
        result.all_edges =
          std::make_shared<const CellEdges<dim>>(std::move(every_second));
      }
    result.set_sizes();
    return result;
  }



  template <int dim>
  MultiIndex<dim>
  Lattice<dim>::find_cell(const Point<dim> &point) const
  {
    if (levels)
      return levels->find(point);
    MultiIndex<dim> index;
    for (unsigned int d = 0; d < dim; ++d)
      {
        if (!edges(d).empty())
          {
            const std::vector<double> &given = edges(d);
            index[d] =
              std::upper_bound(given.begin() + 1, given.end() - 1, point[d]) -
              given.begin() - 1;
            continue;
          }
        const double h        = cell_size(d);
        const double position = (point[d] - lower_corner[d]) / h;
        index[d] = std::min<double>(std::max(position, 0.), cells[d] - 1);

        // The cell follows from the corners of cells, not from the rounded
        // quotient.
        if (index[d] > 0 && point[d] < lower_corner[d] + index[d] * h)
          --index[d];
        else if (index[d] + 1 < cells[d] &&
                 point[d] >= lower_corner[d] + (index[d] + 1) * h)
          ++index[d];
      }
    return index;
  }



  namespace
  {
    /// Throws dealii::ExcMessage for arguments that create_box_mesh() refuses.
    template <int dim>
    void
    check_box(const Point<dim>            &lower,
              const Point<dim>            &upper,
              const MultiIndex<dim>       &n_cells,
              const std::array<bool, dim> &periodic,
              const CellEdges<dim>        &edges)
    {
      for (unsigned int d = 0; d < dim; ++d)
        {
          Require(n_cells[d] > 0,
                  "A box mesh needs at least one cell in each direction.");
          Require(lower[d] < upper[d],
                  "The lower corner of a box has to be below its upper corner "
                  "in each direction.");
          if (edges[d].empty())
            continue;
          Require(edges[d].size() == n_cells[d] + 1 &&
                    edges[d].front() == lower[d] &&
                    edges[d].back() == upper[d] &&
                    std::adjacent_find(edges[d].begin(),
                                       edges[d].end(),
                                       std::greater_equal<double>()) ==
                      edges[d].end(),
                  "The edges of cells have to increase from the lower to the "
                  "upper corner of a box, one more than there are cells.");
          Require(!periodic[d],
                  "Cells in a periodic direction have to be equal: there are "
                  "no edges between them.");
        }
    }
  } // namespace



  template <int dim>
  void
  adapt_box_mesh(DistributedTriangulation<dim>                   &triangulation,
                 const std::shared_ptr<const CellHierarchy<dim>> &levels)
  {
    triangulation.set_manifold(
      0,
      EdgeManifold<dim>(std::make_shared<const CellEdges<dim>>(
                          levels->finest_edges()),
                        levels));
    const MPI_Comm     comm = get_communicator(triangulation);
    const unsigned int first =
      CoarseCells<dim>(levels->n_cells(0)).n_refinements;
    // p4est joins the children of a cell when no neighbor is smaller.
    for (unsigned int k = 0; k <= 3 * levels->n_levels(); ++k)
      {
        bool changes = false;
        run_on_all(comm, [&]() {
          for (const auto &cell : triangulation.active_cell_iterators())
            if (cell->is_locally_owned())
              {
                const unsigned int here = cell->level() - first;
                const unsigned int wanted =
                  levels->level(levels->find(cell->center()));
                changes = changes || wanted != here;
                if (wanted > here)
                  cell->set_refine_flag();
                else if (wanted < here)
                  cell->set_coarsen_flag();
              }
        });
        if (!Utilities::MPI::logical_or(changes, comm))
          return;
        triangulation.execute_coarsening_and_refinement();
      }
    Require(false, "The mesh cannot be refined as its levels require.");
  }



  template <int dim>
  std::vector<std::uint64_t>
  refined_cells(const DistributedTriangulation<dim> &triangulation)
  {
    const Lattice<dim>         lattice(triangulation);
    const CellHierarchy<dim>  &levels = *lattice.hierarchy();
    std::vector<std::uint64_t> own, result;
    for (const auto &cell : triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          MultiIndex<dim> index = lattice.find_cell(cell->center());
          while (levels.level(index) > 0)
            {
              index = levels.parent(index);
              own.push_back(lexicographic<dim>(index, lattice.n_cells()));
            }
        }
    const auto make_unique = [](std::vector<std::uint64_t> &cells) {
      std::sort(cells.begin(), cells.end());
      cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    };
    make_unique(own);
    for (const auto &of_process :
         Utilities::MPI::all_gather(get_communicator(triangulation), own))
      result.insert(result.end(), of_process.begin(), of_process.end());
    make_unique(result);
    return result;
  }



  template <int dim>
  void
  create_box_mesh(DistributedTriangulation<dim> &triangulation,
                  const Point<dim>              &lower,
                  const Point<dim>              &upper,
                  const MultiIndex<dim>         &n_cells,
                  const std::array<bool, dim>   &periodic,
                  const CellEdges<dim>          &edges,
                  const std::shared_ptr<const CellHierarchy<dim>> &levels)
  {
    check_box<dim>(lower, upper, n_cells, periodic, edges);
    const CoarseCells<dim>           trees(n_cells);
    std::vector<std::vector<double>> sizes(dim);
    bool                             has_manifold = bool(levels);
    for (unsigned int d = 0; d < dim; ++d)
      {
        Require(!levels || !periodic[d], "A refined grid cannot be periodic.");
        has_manifold = has_manifold || !edges[d].empty();
        for (unsigned int k = 0; k < trees.n[d]; ++k)
          {
            const unsigned int step = n_cells[d] / trees.n[d];
            sizes[d].push_back(
              edges[d].empty() ? (upper[d] - lower[d]) / trees.n[d]
                               : edges[d][(k + 1) * step] - edges[d][k * step]);
          }
      }
    if (has_manifold)
      {
        GridGenerator::subdivided_hyper_rectangle(
          triangulation, sizes, lower, upper, true);
        triangulation.set_all_manifold_ids(0);
        triangulation.set_manifold(
          0,
          EdgeManifold<dim>(std::make_shared<const CellEdges<dim>>(
                              levels ? levels->finest_edges() : edges),
                            levels));
      }
    else
      GridGenerator::subdivided_hyper_rectangle(
        triangulation,
        std::vector<unsigned int>(trees.n.begin(), trees.n.end()),
        lower,
        upper,
        true);
    std::vector<GridTools::PeriodicFacePair<
      typename DistributedTriangulation<dim>::cell_iterator>>
      pairs;
    for (unsigned int d = 0; d < dim; ++d)
      if (periodic[d])
        GridTools::collect_periodic_faces(
          triangulation, 2 * d, 2 * d + 1, d, pairs);
    if (!pairs.empty())
      triangulation.add_periodicity(pairs);
    triangulation.refine_global(trees.n_refinements);
    if (levels)
      adapt_box_mesh<dim>(triangulation, levels);
  }



  GREVILLE_INSTANTIATE_CLASS(Lattice);
  GREVILLE_INSTANTIATE(create_box_mesh);
  GREVILLE_INSTANTIATE(adapt_box_mesh);
  GREVILLE_INSTANTIATE(refined_cells);
} // namespace greville
