#include <deal.II/base/mpi.h>

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/simulation/run.h>

#include <chrono>
#include <iostream>
#include <thread>

/**
 * greville FILE.prm        run the simulation of a parameter file
 * greville --parameters    print the reference of all parameters
 */
int
main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const unsigned int                       process =
    dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
  try
    {
      AssertThrow(argc == 2,
                  dealii::ExcMessage("Usage: greville FILE.prm, or greville "
                                     "--parameters"));
      if (std::string(argv[1]) == "--parameters")
        {
          const greville::SimulationParameters parameters("");
          if (process == 0)
            greville::print_parameter_reference(std::cout, "greville");
        }
      else
        greville::run_simulations(argv[1], MPI_COMM_WORLD);
      return 0;
    }
  catch (const std::exception &error)
    {
      // Mostly all processes find the same error; the first one reports it and
      // ends the others before they do.
      if (process > 0)
        std::this_thread::sleep_for(std::chrono::seconds(2));
      std::cerr << "greville: " << greville::message_of(error) << std::endl;
      MPI_Abort(MPI_COMM_WORLD, 1);
      return 1;
    }
}
