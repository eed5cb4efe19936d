/* SPDX-License-Identifier: LGPL-2.1-or-later */

/* Counts messages and collective calls of any MPI program without changing
   it:

     mpicc -shared -fPIC -O2 benchmarks/count_messages.c -o build/count_messages.so
     mpirun -np 4 -x LD_PRELOAD=build/count_messages.so build/greville FILE.prm

   For the process that sends most bytes, MPI_Finalize() then prints the
   messages to others and their bytes, and the collective calls with their
   bytes of input. scripts/performance takes the difference of two runs of
   different length to find the values of a step. */

#include <mpi.h>
#include <stdio.h>

enum { MESSAGES, REDUCTIONS, BARRIERS, GATHERS, OTHERS, N_KINDS };
static const char *const names[N_KINDS] = {
  "messages", "reductions", "barriers", "gathers", "other_collectives"};
static double calls[N_KINDS], bytes[N_KINDS];

static void
count(const int kind, const double n, const MPI_Datatype type)
{
  int size = 0;
  PMPI_Type_size(type, &size);
  calls[kind] += 1;
  bytes[kind] += n * size;
}

static int
n_processes(const MPI_Comm comm)
{
  int n = 1;
  PMPI_Comm_size(comm, &n);
  return n;
}

/* A function that counts n entries of a kind, and calls MPI. */
#define WRAP(name, kind, n, type, parameters, arguments) \
  int MPI_##name parameters                              \
  {                                                      \
    count(kind, n, type);                                \
    return PMPI_##name arguments;                        \
  }

#define TO const void *from, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm
#define SEND(name) WRAP(name, MESSAGES, n, type, (TO), (from, n, type, to, tag, comm))
#define ISEND(name)                                      \
  WRAP(name, MESSAGES, n, type, (TO, MPI_Request *request), \
       (from, n, type, to, tag, comm, request))
SEND(Send)
SEND(Ssend)
SEND(Rsend)
SEND(Bsend)
ISEND(Isend)
ISEND(Issend)
ISEND(Irsend)

#define REDUCE const void *from, void *to, int n, MPI_Datatype type, MPI_Op op
WRAP(Allreduce, REDUCTIONS, n, type, (REDUCE, MPI_Comm comm),
     (from, to, n, type, op, comm))
WRAP(Iallreduce, REDUCTIONS, n, type, (REDUCE, MPI_Comm comm, MPI_Request *request),
     (from, to, n, type, op, comm, request))
WRAP(Reduce, REDUCTIONS, n, type, (REDUCE, int root, MPI_Comm comm),
     (from, to, n, type, op, root, comm))
WRAP(Scan, REDUCTIONS, n, type, (REDUCE, MPI_Comm comm), (from, to, n, type, op, comm))
WRAP(Exscan, REDUCTIONS, n, type, (REDUCE, MPI_Comm comm),
     (from, to, n, type, op, comm))
/* An entry for each process: of global size. */
WRAP(Reduce_scatter_block, GATHERS, (double)n * n_processes(comm), type,
     (REDUCE, MPI_Comm comm), (from, to, n, type, op, comm))

WRAP(Barrier, BARRIERS, 0, MPI_BYTE, (MPI_Comm comm), (comm))
WRAP(Ibarrier, BARRIERS, 0, MPI_BYTE, (MPI_Comm comm, MPI_Request *request),
     (comm, request))
WRAP(Bcast, OTHERS, n, type,
     (void *buffer, int n, MPI_Datatype type, int root, MPI_Comm comm),
     (buffer, n, type, root, comm))

#define GATHER \
  const void *from, int n, MPI_Datatype type, void *to, int n_to, MPI_Datatype type_to
WRAP(Gather, GATHERS, (double)n * n_processes(comm), type,
     (GATHER, int root, MPI_Comm comm), (from, n, type, to, n_to, type_to, root, comm))
WRAP(Allgather, GATHERS, (double)n_to * n_processes(comm), type_to,
     (GATHER, MPI_Comm comm), (from, n, type, to, n_to, type_to, comm))
WRAP(Alltoall, GATHERS, (double)n_to * n_processes(comm), type_to,
     (GATHER, MPI_Comm comm), (from, n, type, to, n_to, type_to, comm))

static double
sum_of(const int *numbers, const MPI_Comm comm)
{
  double sum = 0;
  for (int k = 0; k < n_processes(comm); ++k)
    sum += numbers[k];
  return sum;
}

WRAP(Allgatherv, GATHERS, sum_of(n_to, comm), type_to,
     (const void *from, int n, MPI_Datatype type, void *to, const int *n_to,
      const int *where, MPI_Datatype type_to, MPI_Comm comm),
     (from, n, type, to, n_to, where, type_to, comm))

int
MPI_Finalize(void)
{
  int rank = 0;
  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  struct
  {
    double bytes;
    int    rank;
  } own = {bytes[MESSAGES], rank}, most;
  PMPI_Allreduce(&own, &most, 1, MPI_DOUBLE_INT, MPI_MAXLOC, MPI_COMM_WORLD);
  if (rank == most.rank)
    {
      fprintf(stderr, "count_messages:");
      for (int kind = 0; kind < N_KINDS; ++kind)
        fprintf(stderr, " %s %.0f %.0f", names[kind], calls[kind], bytes[kind]);
      fprintf(stderr, "\n");
    }
  return PMPI_Finalize();
}
