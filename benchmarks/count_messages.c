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

#define SEND(name)                                                      \
  int MPI_##name(const void  *buffer,                                   \
                 int          n,                                        \
                 MPI_Datatype type,                                     \
                 int          to,                                       \
                 int          tag,                                      \
                 MPI_Comm     comm)                                     \
  {                                                                     \
    count(MESSAGES, n, type);                                           \
    return PMPI_##name(buffer, n, type, to, tag, comm);                 \
  }
SEND(Send)
SEND(Ssend)
SEND(Rsend)
SEND(Bsend)

#define ISEND(name)                                                     \
  int MPI_##name(const void  *buffer,                                   \
                 int          n,                                        \
                 MPI_Datatype type,                                     \
                 int          to,                                       \
                 int          tag,                                      \
                 MPI_Comm     comm,                                     \
                 MPI_Request *request)                                  \
  {                                                                     \
    count(MESSAGES, n, type);                                           \
    return PMPI_##name(buffer, n, type, to, tag, comm, request);        \
  }
ISEND(Isend)
ISEND(Issend)
ISEND(Irsend)

int
MPI_Allreduce(const void  *from,
              void        *to,
              int          n,
              MPI_Datatype type,
              MPI_Op       op,
              MPI_Comm     comm)
{
  count(REDUCTIONS, n, type);
  return PMPI_Allreduce(from, to, n, type, op, comm);
}

int
MPI_Iallreduce(const void  *from,
               void        *to,
               int          n,
               MPI_Datatype type,
               MPI_Op       op,
               MPI_Comm     comm,
               MPI_Request *request)
{
  count(REDUCTIONS, n, type);
  return PMPI_Iallreduce(from, to, n, type, op, comm, request);
}

int
MPI_Reduce(const void  *from,
           void        *to,
           int          n,
           MPI_Datatype type,
           MPI_Op       op,
           int          root,
           MPI_Comm     comm)
{
  count(REDUCTIONS, n, type);
  return PMPI_Reduce(from, to, n, type, op, root, comm);
}

int
MPI_Scan(const void  *from,
         void        *to,
         int          n,
         MPI_Datatype type,
         MPI_Op       op,
         MPI_Comm     comm)
{
  count(REDUCTIONS, n, type);
  return PMPI_Scan(from, to, n, type, op, comm);
}

int
MPI_Exscan(const void  *from,
           void        *to,
           int          n,
           MPI_Datatype type,
           MPI_Op       op,
           MPI_Comm     comm)
{
  count(REDUCTIONS, n, type);
  return PMPI_Exscan(from, to, n, type, op, comm);
}

int
MPI_Reduce_scatter_block(const void  *from,
                         void        *to,
                         int          n,
                         MPI_Datatype type,
                         MPI_Op       op,
                         MPI_Comm     comm)
{
  /* An entry for each process: of global size. */
  count(GATHERS, (double)n * n_processes(comm), type);
  return PMPI_Reduce_scatter_block(from, to, n, type, op, comm);
}

int
MPI_Barrier(MPI_Comm comm)
{
  calls[BARRIERS] += 1;
  return PMPI_Barrier(comm);
}

int
MPI_Ibarrier(MPI_Comm comm, MPI_Request *request)
{
  calls[BARRIERS] += 1;
  return PMPI_Ibarrier(comm, request);
}

int
MPI_Bcast(void *buffer, int n, MPI_Datatype type, int root, MPI_Comm comm)
{
  count(OTHERS, n, type);
  return PMPI_Bcast(buffer, n, type, root, comm);
}

int
MPI_Gather(const void  *from,
           int          n,
           MPI_Datatype type,
           void        *to,
           int          n_to,
           MPI_Datatype type_to,
           int          root,
           MPI_Comm     comm)
{
  count(GATHERS, (double)n * n_processes(comm), type);
  return PMPI_Gather(from, n, type, to, n_to, type_to, root, comm);
}

int
MPI_Allgather(const void  *from,
              int          n,
              MPI_Datatype type,
              void        *to,
              int          n_to,
              MPI_Datatype type_to,
              MPI_Comm     comm)
{
  count(GATHERS, (double)n_to * n_processes(comm), type_to);
  return PMPI_Allgather(from, n, type, to, n_to, type_to, comm);
}

int
MPI_Allgatherv(const void  *from,
               int          n,
               MPI_Datatype type,
               void        *to,
               const int   *n_to,
               const int   *where,
               MPI_Datatype type_to,
               MPI_Comm     comm)
{
  double sum = 0;
  for (int k = 0; k < n_processes(comm); ++k)
    sum += n_to[k];
  count(GATHERS, sum, type_to);
  return PMPI_Allgatherv(from, n, type, to, n_to, where, type_to, comm);
}

int
MPI_Alltoall(const void  *from,
             int          n,
             MPI_Datatype type,
             void        *to,
             int          n_to,
             MPI_Datatype type_to,
             MPI_Comm     comm)
{
  count(GATHERS, (double)n_to * n_processes(comm), type_to);
  return PMPI_Alltoall(from, n, type, to, n_to, type_to, comm);
}

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
