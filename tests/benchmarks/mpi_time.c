/* Processor time outside of MPI, by PMPI: cc -shared -fPIC -o mpi_time.so mpi_time.c, in LD_PRELOAD.

   Ranks that wait for others do so inside of MPI, and keep their processor busy. Every argument of these calls
   is an integer or an address and fits into a long, whatever MPI it is, so no header is needed. */

#include <time.h>

static double inside;
static int depth;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

/* Processor time of this process so far without that in MPI [s]. */
double seconds_outside_mpi(void) { return now() - inside; }

#define TIMED(NAME)                                                                                            \
    int PMPI_##NAME(long, long, long, long, long, long, long, long, long, long, long, long);                   \
    int MPI_##NAME(long a, long b, long c, long d, long e, long f, long g, long h, long i, long j, long k,     \
                   long l)                                                                                     \
    {                                                                                                          \
        double begun = depth++ ? 0.0 : now();                                                                  \
        int error = PMPI_##NAME(a, b, c, d, e, f, g, h, i, j, k, l);                                           \
        if (!--depth)                                                                                          \
            inside += now() - begun;                                                                           \
        return error;                                                                                          \
    }

TIMED(Allgather) TIMED(Allgatherv) TIMED(Allreduce) TIMED(Alltoall) TIMED(Alltoallv) TIMED(Barrier)
TIMED(Bcast) TIMED(Exscan) TIMED(Gather) TIMED(Gatherv) TIMED(Iprobe) TIMED(Irecv) TIMED(Isend)
TIMED(Probe) TIMED(Recv) TIMED(Reduce) TIMED(Scan) TIMED(Scatter) TIMED(Send) TIMED(Sendrecv)
TIMED(Start) TIMED(Startall) TIMED(Test) TIMED(Testall) TIMED(Wait) TIMED(Waitall) TIMED(Waitany)
TIMED(Waitsome) TIMED(Mprobe) TIMED(Mrecv) TIMED(Improbe) TIMED(Ibarrier) TIMED(Comm_split)
