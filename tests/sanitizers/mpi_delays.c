/* SPDX-License-Identifier: LGPL-2.1-or-later */

/*
 * Makes messages late: before each call that sends or that all processes take
 * part in, a process sleeps for a random time, different on each of them.
 * Preloaded by scripts/sanitize, so that orders of messages are seen that a
 * quiet machine never shows. MPI_DELAY is the longest time in microseconds, and
 * MPI_DELAY_SEED the beginning of the random numbers.
 */

#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static unsigned int  state   = 0;
static unsigned int  longest = 0;
static unsigned long n_calls = 0;

static void
sleep_a_while(void)
{
  if (state == 0)
    {
      const char *time = getenv("MPI_DELAY"), *seed = getenv("MPI_DELAY_SEED");
      int         process;
      PMPI_Comm_rank(MPI_COMM_WORLD, &process);
      longest = time ? (unsigned int)atoi(time) : 300;
      state   = (seed ? (unsigned int)atoi(seed) : 1) * 7919u + process + 1u;
    }
  ++n_calls;
  const unsigned int pause = (unsigned int)rand_r(&state) % (longest + 1);
  /* Half of the calls are not late. */
  if (longest > 0 && rand_r(&state) % 2 == 0)
    usleep(pause);
}

/* So that a run in which nothing was late is seen. */
int
MPI_Finalize(void)
{
  int         process;
  const char *file = getenv("MPI_DELAY_COUNTS");
  PMPI_Comm_rank(MPI_COMM_WORLD, &process);
  if (file)
    {
      FILE *out = fopen(file, "a");
      if (out)
        {
          fprintf(out, "%d %lu\n", process, n_calls);
          fclose(out);
        }
    }
  return PMPI_Finalize();
}

#define LATE(name, parameters, arguments) \
  int name parameters                     \
  {                                       \
    sleep_a_while();                      \
    return P##name arguments;             \
  }

LATE(MPI_Send,
     (const void *a, int n, MPI_Datatype t, int to, int tag, MPI_Comm c),
     (a, n, t, to, tag, c))
LATE(MPI_Isend,
     (const void  *a,
      int          n,
      MPI_Datatype t,
      int          to,
      int          tag,
      MPI_Comm     c,
      MPI_Request *r),
     (a, n, t, to, tag, c, r))
LATE(MPI_Issend,
     (const void  *a,
      int          n,
      MPI_Datatype t,
      int          to,
      int          tag,
      MPI_Comm     c,
      MPI_Request *r),
     (a, n, t, to, tag, c, r))
LATE(MPI_Irecv,
     (void        *a,
      int          n,
      MPI_Datatype t,
      int          from,
      int          tag,
      MPI_Comm     c,
      MPI_Request *r),
     (a, n, t, from, tag, c, r))
LATE(MPI_Waitall,
     (int n, MPI_Request r[], MPI_Status s[]),
     (n, r, s))
LATE(MPI_Barrier, (MPI_Comm c), (c))
LATE(MPI_Ibarrier, (MPI_Comm c, MPI_Request *r), (c, r))
LATE(MPI_Bcast,
     (void *a, int n, MPI_Datatype t, int root, MPI_Comm c),
     (a, n, t, root, c))
LATE(MPI_Allreduce,
     (const void *a, void *b, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c),
     (a, b, n, t, o, c))
LATE(MPI_Exscan,
     (const void *a, void *b, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c),
     (a, b, n, t, o, c))
LATE(MPI_Allgather,
     (const void  *a,
      int          n,
      MPI_Datatype t,
      void        *b,
      int          m,
      MPI_Datatype u,
      MPI_Comm     c),
     (a, n, t, b, m, u, c))
LATE(MPI_Allgatherv,
     (const void  *a,
      int          n,
      MPI_Datatype t,
      void        *b,
      const int    m[],
      const int    d[],
      MPI_Datatype u,
      MPI_Comm     c),
     (a, n, t, b, m, d, u, c))
LATE(MPI_Alltoall,
     (const void  *a,
      int          n,
      MPI_Datatype t,
      void        *b,
      int          m,
      MPI_Datatype u,
      MPI_Comm     c),
     (a, n, t, b, m, u, c))
