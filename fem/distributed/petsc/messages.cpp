#include "fem/distributed/petsc/messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <new>
#include <thread>

#include "fem/distributed/petsc/petsc_handles.h"
#include "mesh/errors.h"

namespace palpate::fem {
namespace {

void check_mpi(int code) {
    if (code != MPI_SUCCESS) throw SolverFailure(fmt::format("MPI failed with code {}", code));
}

constexpr std::size_t longest = 1 << 30;  // of a message [bytes]: MPI counts in int

void send_bytes(const void* data, std::size_t length, int process) {
    const auto* bytes = static_cast<const char*>(data);
    for (std::size_t at = 0; at < length; at += longest) {
        check_mpi(MPI_Send(bytes + at, static_cast<int>(std::min(longest, length - at)), MPI_BYTE, process, 0,
                           PETSC_COMM_WORLD));
    }
}

template <class T>
void send_values(const T* data, std::size_t count, int process) {
    send_bytes(&count, sizeof count, process);
    send_bytes(data, count * sizeof(T), process);
}

void receive_bytes(void* data, std::size_t length) {
    auto* bytes = static_cast<char*>(data);
    for (std::size_t at = 0; at < length; at += longest) {
        check_mpi(MPI_Recv(bytes + at, static_cast<int>(std::min(longest, length - at)), MPI_BYTE, 0, 0,
                           PETSC_COMM_WORLD, MPI_STATUS_IGNORE));
    }
}

template <class T>
std::vector<T> receive_values() {
    std::size_t count = 0;
    receive_bytes(&count, sizeof count);
    std::vector<T> values(count);
    receive_bytes(values.data(), count * sizeof(T));
    return values;
}

}  // namespace

void check_petsc(PetscErrorCode code, const char* doing) {
    if (code == 0) return;
    if (code == PETSC_ERR_MEM) throw std::bad_alloc();
    const char* words = nullptr;
    char* specific = nullptr;
    PetscErrorMessage(code, &words, &specific);
    throw SolverFailure(fmt::format("PETSc failed {}: {}{}{}", doing, words ? words : "error", specific ? ", " : "",
                                    specific ? specific : fmt::format(" {}", static_cast<int>(code))));
}

bool petsc_runs() {
    PetscBool runs = PETSC_FALSE;
    PetscInitialized(&runs);
    return runs;
}

void start_petsc() {
    if (petsc_runs()) return;
    // Bodies are solved for by whichever thread asks, one at a time.
    int runs = 0, threads = 0;
    check_mpi(MPI_Initialized(&runs));
    if (!runs) check_mpi(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &threads));
    check_petsc(PetscInitializeNoArguments(), "to start");
    check_petsc(PetscPushErrorHandler(PetscReturnErrorHandler, nullptr), "to start");
    check_petsc(PetscPopSignalHandler(), "to start");  // interrupts are the program's own
}

void stop_petsc() {
    if (!petsc_runs()) return;
    PetscFinalize();
    MPI_Finalize();
}

int process_rank() {
    int rank = 0;
    check_mpi(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
    return rank;
}

int process_count() {
    int count = 1;
    check_mpi(MPI_Comm_size(PETSC_COMM_WORLD, &count));
    return count;
}

void send_request(const Request& request) {
    Request message = request;
    MPI_Request sent = MPI_REQUEST_NULL;
    check_mpi(MPI_Ibcast(&message, sizeof message, MPI_BYTE, 0, PETSC_COMM_WORLD, &sent));
    check_mpi(MPI_Wait(&sent, MPI_STATUS_IGNORE));
}

Request await_request() {
    Request message;
    MPI_Request received = MPI_REQUEST_NULL;
    check_mpi(MPI_Ibcast(&message, sizeof message, MPI_BYTE, 0, PETSC_COMM_WORLD, &received));
    for (int done = 0; !done;) {
        check_mpi(MPI_Test(&received, &done, MPI_STATUS_IGNORE));
        // MPI itself waits by spinning, and the leader may need the core.
        if (!done) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return message;
}

void send_part(const BodyPart& part, int process) {
    const std::array<int, 4> head{part.first, part.own, static_cast<int>(part.mesh.tetrahedra.cols()),
                                  static_cast<int>(part.dilatation)};
    send_values(head.data(), head.size(), process);
    send_values(part.mesh.nodes.data(), static_cast<std::size_t>(part.mesh.nodes.size()), process);
    send_values(part.mesh.tetrahedra.data(), static_cast<std::size_t>(part.mesh.tetrahedra.size()), process);
    send_values(part.number.data(), part.number.size(), process);
    send_values(&part.materials.body, 1, process);
    send_values(part.materials.regions.data(), part.materials.regions.size(), process);
    send_values(part.materials.of_element.data(), part.materials.of_element.size(), process);
}

BodyPart receive_part() {
    BodyPart part;
    const auto head = receive_values<int>();
    part.first = head[0];
    part.own = head[1];
    part.dilatation = static_cast<Dilatation>(head[3]);
    const auto nodes = receive_values<double>();
    part.mesh.nodes = Eigen::Map<const Points>(nodes.data(), std::ssize(nodes) / 3, 3);
    const auto tetrahedra = receive_values<int>();
    part.mesh.tetrahedra = Eigen::Map<const Tetrahedra>(tetrahedra.data(), std::ssize(tetrahedra) / head[2], head[2]);
    part.number = receive_values<int>();
    part.materials.body = receive_values<Material>().front();
    part.materials.regions = receive_values<Material>();
    part.materials.of_element = receive_values<int>();
    return part;
}

void send_rows(const MatrixRows& rows, int process) {
    const std::array<int, 2> head{rows.first, rows.blocks.columns};
    send_values(head.data(), head.size(), process);
    send_values(rows.blocks.start.data(), rows.blocks.start.size(), process);
    send_values(rows.blocks.column.data(), rows.blocks.column.size(), process);
    send_values(rows.blocks.values.data(), rows.blocks.values.size(), process);
    send_values(rows.positions.data(), static_cast<std::size_t>(rows.positions.size()), process);
}

MatrixRows receive_rows() {
    const auto head = receive_values<int>();
    MatrixRows rows{head[0], {head[1], {}, {}, {}}, {}};
    rows.blocks.start = receive_values<std::int64_t>();
    rows.blocks.column = receive_values<int>();
    rows.blocks.values = receive_values<double>();
    const auto positions = receive_values<double>();
    rows.positions = Eigen::Map<const Points>(positions.data(), std::ssize(positions) / 3, 3);
    return rows;
}

bool anywhere(bool is_true) {
    int here = is_true ? 1 : 0, all = 0;
    check_mpi(MPI_Allreduce(&here, &all, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD));
    return all != 0;
}

void collectively(const std::function<void()>& work) {
    const auto end_all = [](const char* what) {
        fmt::print(stderr, "palpate: process {} of {}: {}\n", process_rank() + 1, process_count(), what);
        MPI_Abort(PETSC_COMM_WORLD, 4);
    };
    try {
        work();
    } catch (const std::bad_alloc&) {
        if (process_count() > 1) end_all("the memory is exhausted: start processes on more machines");
        throw;
    } catch (const SolverFailure&) {
        throw;
    } catch (const InvalidInput&) {
        throw;
    } catch (const std::exception& e) {
        if (process_count() > 1) end_all(e.what());
        throw;
    }
}

}  // namespace palpate::fem
