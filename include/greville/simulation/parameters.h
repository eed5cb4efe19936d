#ifndef greville_simulation_parameters_h
#define greville_simulation_parameters_h

#include <deal.II/base/parameter_acceptor.h>

#include <greville/base/parameters.h>
#include <greville/materials/material.h>
#include <greville/multigrid/mass_solver.h>
#include <greville/particles/body.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace greville
{
  /**
   * What is simulated.
   */
  class GeneralParameters : public dealii::ParameterAcceptor
  {
  public:
    GeneralParameters();

    std::string              name;
    unsigned int             dimension = 2;
    std::vector<std::string> bodies;
    std::vector<std::string> materials;
    std::vector<std::string> tractions;
  };



  /**
   * The background grid.
   */
  class GridParameters : public dealii::ParameterAcceptor
  {
  public:
    GridParameters();

    std::vector<double>       lower  = {0., 0.};
    std::vector<double>       upper  = {1., 1.};
    std::vector<unsigned int> cells  = {16, 16};
    unsigned int              degree = 2;
  };



  /**
   * The time stepping.
   */
  class TimeParameters : public dealii::ParameterAcceptor
  {
  public:
    TimeParameters();

    double       end = 1.;
    std::string  step;
    double       cfl            = 0.5;
    double       safety         = 0.7;
    std::string  too_large_step = "refuse";
    unsigned int estimate_every = 20;
    std::string  velocities     = "half steps";
    unsigned int max_steps      = 0;
  };



  /**
   * How points and grid exchange what they know.
   */
  class SchemeParameters : public dealii::ParameterAcceptor
  {
  public:
    SchemeParameters();

    std::string mass             = "auto";
    double      filling          = 0.45;
    double      filter           = 0.4;
    std::string energy_gain      = "stop";
    double      energy_tolerance = 0.1;
    double      flip_time        = 0.;
    std::string stress_update    = "USL";
    std::string transfer         = "FLIP";
    double      flip             = 1.;
    std::string quadrature       = "points";
    double      full_cell        = 0.5;
    std::string outside          = "error";
  };



  /**
   * The solver of the consistent mass.
   */
  class ConsistentSolverParameters : public MassSolverParameters
  {
  public:
    ConsistentSolverParameters();

    /// One of ConsistentMass::methods().
    std::string method = "cg-ic0";
  };



  /**
   * The walls of the grid.
   */
  class WallParameters : public dealii::ParameterAcceptor
  {
  public:
    WallParameters();

    /// In the order of the faces of a cell of deal.II.
    static const std::array<std::string, 6> names;

    std::array<std::string, 6> type;
    std::array<std::string, 6> velocity;
    std::array<double, 6>      friction{};
  };



  /**
   * Forces on points, and damping.
   */
  class LoadParameters : public dealii::ParameterAcceptor
  {
  public:
    LoadParameters();

    std::string gravity;
    std::string body_force;
    double      cundall     = 0.;
    bool        kinetic     = false;
    double      damping_end = -1.;
  };



  /**
   * A traction on the points of a surface.
   */
  class TractionParameters : public dealii::ParameterAcceptor
  {
  public:
    TractionParameters(const std::string &section);

    std::string shape;
    std::string traction;
    double      area = 0.;
  };



  /**
   * Exact solutions, and runs over many meshes.
   */
  class ExactParameters : public dealii::ParameterAcceptor
  {
  public:
    ExactParameters();

    std::string displacement;
    std::string velocity;
    std::string stress;
  };

  class SweepParameters : public dealii::ParameterAcceptor
  {
  public:
    SweepParameters();

    std::vector<unsigned int> cells;
    std::vector<unsigned int> degrees;
    std::vector<std::string>  masses;
    std::vector<std::string>  quadratures;
  };



  /**
   * Measured data to compare with.
   */
  class ReferenceParameters : public dealii::ParameterAcceptor
  {
  public:
    ReferenceParameters();

    std::string surface_file;
    std::string series_file;
    std::string series_quantity = "front";
    double      time_unit       = 1.;
    double      value_unit      = 1.;
  };



  /**
   * What a run leaves.
   */
  class OutputParameters : public dealii::ParameterAcceptor
  {
  public:
    OutputParameters();

    std::string directory;
    double      fields_every     = 0.;
    double      statistics_every = 0.;
    bool        grid_fields      = true;
    std::string probes;
    bool        print_times = true;
  };



  /**
   * All parameters of a simulation. Bodies, materials and tractions have a
   * section each, whose names the file itself gives.
   */
  class SimulationParameters
  {
    /**
     * The sections are declared in the one ParameterHandler of
     * dealii::ParameterAcceptor: without what others have declared there.
     */
    struct Registration
    {
      Registration();
    };
    const Registration registration;

  public:
    /**
     * Read a file; throws where it is wrong, with the line.
     */
    explicit SimulationParameters(const std::string &file);

    /**
     * Declare one body, one traction and all materials, for
     * print_parameter_reference().
     */
    SimulationParameters();
    ~SimulationParameters();

    SimulationParameters(const SimulationParameters &) = delete;
    SimulationParameters &
    operator=(const SimulationParameters &) = delete;

    GeneralParameters   general;
    GridParameters      grid;
    TimeParameters      time;
    SchemeParameters    scheme;
    WallParameters      walls;
    LoadParameters      loads;
    ExactParameters     exact;
    SweepParameters     sweep;
    ReferenceParameters reference;
    OutputParameters    output;

    ConsistentSolverParameters solver;
    /// A symmetric cycle, for conjugate gradients.
    PMultigridParameters multigrid{"p-multigrid",
                                   "one by one",
                                   "transpose",
                                   "ic0"};
    SmootherParameters   smoother{"Smoother", 2};

    // By name.
    std::map<std::string, std::unique_ptr<BodyParameters>>     bodies;
    std::map<std::string, std::unique_ptr<Material>>           materials;
    std::map<std::string, std::unique_ptr<TractionParameters>> tractions;

    /// What the files of the parameters are relative to.
    std::string directory;

    /**
     * The file @p name beside the parameter file.
     */
    std::string
    path_of(const std::string &name) const;

    /**
     * All parameters as a file that gives the same run from any folder.
     */
    const std::string &
    used() const
    {
      return used_text;
    }

  private:
    void
    read_names();

    void
    print_used();

    /**
     * Throws where a file means the solver by parameters that do not name it.
     */
    void
    check_method() const;

    /**
     * What "auto" stands for: lumped mass where bodies spread into thin layers,
     * and with APIC; the consistent one otherwise.
     */
    std::string
    default_mass() const;

    /**
     * What patterns cannot check.
     */
    void
    check() const;

    std::vector<ParameterLine> lines;
    std::string                used_text;
  };
} // namespace greville

#endif
