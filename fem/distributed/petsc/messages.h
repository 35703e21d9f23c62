#pragma once

#include <functional>

#include "fem/distributed/petsc/body_part.h"
#include "fem/linear_algebra/conjugate_gradients.h"

namespace palpate::fem {

/// What the leading process asks the others to do, all of which take part in it.
enum class Task : int { end, hold_part, hold_rows, solve, release };

struct Request {
    Task task = Task::end;
    int body = 0;                     // which of the matrices that are held
    ConjugateGradientsOptions how{};  // to solve
};

/// Rows of a symmetric matrix that one process holds.
struct MatrixRows {
    int first = 0;             // of them in the whole matrix, in nodes
    BlockMatrix<3, 3> blocks;  // (own x all)
    Points positions;          // of their nodes (own x 3)
};

/// Starts MPI and PETSc, unless they run; ends them.
void start_petsc();
void stop_petsc();
bool petsc_runs();
int process_rank();
int process_count();

/// From the leader to all others.
void send_request(const Request& request);
/// Sleeps until one comes.
Request await_request();

void send_part(const BodyPart& part, int process);
BodyPart receive_part();
void send_rows(const MatrixRows& rows, int process);
MatrixRows receive_rows();

/// True if it is true of some process; to be called by all of them.
bool anywhere(bool is_true);
/// Does work that all processes do together. What all of them are thrown out of alike is thrown on; what befalls one,
/// as when its memory is exhausted, would leave the others waiting: all are ended, with a message and exit code 4.
void collectively(const std::function<void()>& work);

}  // namespace palpate::fem
