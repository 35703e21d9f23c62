#include "fem/distributed/distributed_stiffness.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <cstdlib>
#include <map>
#include <mutex>

#include "fem/distributed/petsc/matrix_share.h"
#include "fem/distributed/petsc/messages.h"
#include "fem/distributed/processes.h"
#include "mesh/errors.h"

namespace palpate::fem {
namespace {

bool started_by_mpirun() {
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"})
        if (std::getenv(name)) return true;
    return false;
}

std::mutex solving;

/// The leader's: MPI and PETSc serve one thread at a time, which meanwhile takes up no other work that may want them.
template <class Work>
void one_at_a_time(Work&& work) {
    const std::scoped_lock lock(solving);
    tbb::this_task_arena::isolate(work);
}

}  // namespace

Processes::Processes() {
    // By itself, a program starts MPI only where it is asked for.
    if (started_by_mpirun()) start_petsc();
}

Processes::~Processes() {
    if (!petsc_runs()) return;
    try {
        if (lead() && count() > 1) send_request({Task::end});
        stop_petsc();
    } catch (const std::exception& e) {
        fmt::print(stderr, "palpate: {}\n", e.what());
    }
}

bool Processes::lead() const { return !petsc_runs() || process_rank() == 0; }
int Processes::count() { return petsc_runs() ? process_count() : 1; }

void Processes::serve() {
    std::map<int, std::unique_ptr<MatrixShare>> held;
    for (;;) {
        const Request request = await_request();
        if (request.task == Task::end) return;
        try {
            collectively([&] {
                if (request.task == Task::hold_part) held[request.body] = std::make_unique<MatrixShare>(receive_part());
                if (request.task == Task::hold_rows) held[request.body] = std::make_unique<MatrixShare>(receive_rows());
                if (request.task == Task::solve) held.at(request.body)->solve(nullptr, request.how);
                if (request.task == Task::release) held.erase(request.body);
            });
        } catch (const std::exception&) {
            // The leader, who was thrown out of it alike, says what it was.
        }
    }
}

struct DistributedStiffness::Impl {
    int body = 0;
    std::vector<int> number;
    std::unique_ptr<MatrixShare> share;

    /// Makes the shares of a matrix: `send(process)` those of the others, `own()` the leader's.
    template <class Send, class Own>
    void hold(Task task, Send&& send, Own&& own) {
        static int bodies = 0;
        body = bodies++;
        send_request({task, body});
        collectively([&] {
            for (int process = 1; process < process_count(); ++process) send(process);
            share = std::make_unique<MatrixShare>(own());
        });
    }
};

DistributedStiffness::DistributedStiffness(const mesh::VolumeMesh& mesh, const Materials& materials,
                                           Dilatation dilatation, const std::vector<char>& held)
    : impl_(std::make_unique<Impl>()) {
    one_at_a_time([&] {
        start_petsc();
        Partition partition = partition_nodes(mesh, held, process_count());
        const auto part = [&](int process) { return part_of(mesh, materials, dilatation, partition, process); };
        impl_->hold(
            Task::hold_part, [&](int process) { send_part(part(process), process); }, [&] { return part(0); });
        impl_->number = std::move(partition.number);
    });
}

DistributedStiffness::DistributedStiffness(const BlockMatrix<3, 3>& K, const Points& positions)
    : impl_(std::make_unique<Impl>()) {
    one_at_a_time([&] {
        start_petsc();
        const auto rows = [&](int process) {
            const std::int64_t first = std::int64_t{K.rows()} * process / process_count(),
                               end = std::int64_t{K.rows()} * (process + 1) / process_count();
            MatrixRows some{
                static_cast<int>(first), {K.columns, {0}, {}, {}}, positions.middleRows(first, end - first)};
            for (auto i = first; i < end; ++i) some.blocks.start.push_back(K.start[i + 1] - K.start[first]);
            some.blocks.column.assign(K.column.begin() + K.start[first], K.column.begin() + K.start[end]);
            some.blocks.values.assign(K.values.begin() + 9 * K.start[first], K.values.begin() + 9 * K.start[end]);
            return some;
        };
        impl_->hold(
            Task::hold_rows, [&](int process) { send_rows(rows(process), process); }, [&] { return rows(0); });
    });
}

DistributedStiffness::~DistributedStiffness() {
    if (!impl_->share) return;
    one_at_a_time([&] {
        send_request({Task::release, impl_->body});
        impl_->share.reset();
    });
}

const std::vector<int>& DistributedStiffness::number() const { return impl_->number; }

int DistributedStiffness::solve(MultiVector& X, const ConjugateGradientsOptions& options) {
    int most = 0;
    one_at_a_time([&] {
        Eigen::VectorXd x;
        for (Eigen::Index j = 0; j < X.cols(); ++j) {
            x = X.col(j);
            if (x.isZero(0)) continue;
            send_request({Task::solve, impl_->body, options});
            collectively([&] { most = std::max(most, impl_->share->solve(x.data(), options)); });
            X.col(j) = x;
        }
    });
    return most;
}

std::string DistributedStiffness::description() const { return impl_->share->description(); }

}  // namespace palpate::fem
