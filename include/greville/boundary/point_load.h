// SPDX-License-Identifier: LGPL-2.1-or-later

#ifndef greville_boundary_point_load_h
#define greville_boundary_point_load_h

#include <greville/parameters/simulation_parameters.h>

#include <cctype>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace greville
{
  /**
   * A load on material points. It adds its acceleration to the field "load" of
   * points; what it has to know of a point for that (whether it bears the load,
   * a weight, a normal) it finds out once and keeps in a field of its own.
   *
   * A new load is one header with a class that derives from it, and one line in
   * the list of source/boundary/loads.cc; or a call of add_point_load() in a
   * program.
   */
  template <int dim>
  class PointLoad
  {
  public:
    virtual ~PointLoad() = default;

    /**
     * The parameters that make it strong, for messages.
     */
    virtual std::string
    parameter_names() const = 0;

    /**
     * Add the fields in which it keeps what it knows of points.
     */
    virtual void
    add_fields(PointLayout<dim> &) const
    {}

    /**
     * Collective. Fill these fields, with all points at their first places.
     * Throws dealii::ExcMessage where no point bears the load.
     */
    virtual void
    find_points(std::vector<Body<dim>> &, const MPI_Comm) const
    {}

    /**
     * Add the acceleration at time @p t (s) to the number @p first and the
     * following of all @p points, m / s^2. It may be called several times for
     * the same time: for steps that are tried again, and for output.
     */
    virtual void
    add_acceleration(MaterialPoints<dim> &points,
                     const unsigned int   first,
                     const double         t) const = 0;

    /**
     * The acceleration of a point that is at @p x, m / s^2.
     */
    using AtPosition =
      std::function<dealii::Tensor<1, dim>(const ConstPointRef<dim>  p,
                                           const dealii::Point<dim> &x)>;

    /**
     * For a load that depends on where points are: its acceleration at time
     * @p t (s) of points of this @p layout, which implicit steps take where the
     * step brings the points. Other loads give an empty function.
     */
    virtual AtPosition
    at_position(const PointLayout<dim> &, const double) const
    {
      return {};
    }
  };

  template <int dim>
  using PointLoads = std::vector<std::unique_ptr<PointLoad<dim>>>;

  /**
   * Makes the loads of a kind that parameters ask for.
   */
  template <int dim>
  using MakePointLoads =
    std::function<PointLoads<dim>(const SimulationParameters &parameters)>;

  /**
   * Add a kind of loads to the list, for simulations that are made afterwards.
   */
  template <int dim>
  void
  add_point_load(const MakePointLoads<dim> &make);



  /**
   * A vector from formulas of x, X and t.
   */
  template <int dim>
  class LoadFormulas
  {
  public:
    LoadFormulas(const std::string &text, const std::string &parameter)
      : formulas(text,
                 parameter,
                 dim == 2 ? std::vector<std::string>{"x", "y", "X", "Y", "t"}
                          : std::vector<std::string>{
                              "x", "y", "z", "X", "Y", "Z", "t"})
    {
      std::string word;
      for (const char c : text + ' ')
        if (std::isalnum(static_cast<unsigned char>(c)) || c == '_')
          word += c;
        else
          {
            for (const std::string &name : coordinate_names<dim>())
              with_position = with_position || word == name;
            word.clear();
          }
    }

    /**
     * The value for a point that is at @p x.
     */
    dealii::Tensor<1, dim>
    operator()(const ConstPointRef<dim>  p,
               const dealii::Point<dim> &x,
               const double              t) const
    {
      double arguments[2 * dim + 1];
      for (unsigned int d = 0; d < dim; ++d)
        {
          arguments[d]       = x[d];
          arguments[dim + d] = p.reference(d);
        }
      arguments[2 * dim] = t;
      return formulas(dealii::ArrayView<const double>(arguments, 2 * dim + 1));
    }

    /**
     * Whether x, y or z occurs.
     */
    bool
    use_position() const
    {
      return with_position;
    }

  private:
    VectorExpression<dim> formulas;
    bool                  with_position = false;
  };
} // namespace greville

#endif
