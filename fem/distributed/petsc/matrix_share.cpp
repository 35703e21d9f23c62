#include "fem/distributed/petsc/matrix_share.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "fem/distributed/petsc/messages.h"
#include "fem/elements/assembly.h"
#include "fem/linear_algebra/solver_choice.h"
#include "mesh/errors.h"

namespace palpate::fem {
namespace {

constexpr const char* assembling = "to assemble the stiffness matrix";
constexpr int piece_size = 20000;  // nodes whose rows are assembled at once: some 100 MB

/// Does what this process does alone, and goes on if all processes could: else throws what stopped this one, or says
/// that another was stopped.
template <class Work>
void together(Work&& work) {
    std::exception_ptr failure;
    try {
        work();
    } catch (...) {
        failure = std::current_exception();
    }
    const bool failed = anywhere(failure != nullptr);
    if (failure) std::rethrow_exception(failure);
    if (failed) throw SolverFailure("another process could not assemble its share of the stiffness matrix");
}

/// The piece's free nodes numbered, its own first, and their numbers in the whole matrix.
struct PieceNumbers {
    std::vector<int> number;  // of each node, -1: held
    std::vector<PetscInt> global;

    explicit PieceNumbers(const BodyPart& piece) : number(piece.number.size(), -1) {
        for (std::size_t i = 0; i < number.size(); ++i) {
            if (piece.number[i] < 0) continue;
            number[i] = static_cast<int>(global.size());
            global.push_back(piece.number[i]);
        }
    }
};

void insert(Mat K, PetscInt row, const std::vector<PetscInt>& columns, const double* panel) {
    check_petsc(
        MatSetValuesBlocked(K, 1, &row, static_cast<PetscInt>(columns.size()), columns.data(), panel, INSERT_VALUES),
        assembling);
}

void insert_rows(const BodyPart& piece, Mat K) {
    const PieceNumbers numbers(piece);
    const BlockMatrix<3, 3> blocks = assemble_blocks(piece.mesh, piece.materials, piece.dilatation, numbers.number);
    std::vector<PetscInt> columns;
    for (int i = 0; i < piece.own; ++i) {
        columns.clear();
        for (const int j : blocks.columns_of(i)) columns.push_back(numbers.global[static_cast<std::size_t>(j)]);
        insert(K, piece.first + i, columns, blocks.panel(i).data());
    }
}

/// Would the products that make the coarser levels fit into this machine's memory as PETSc makes them by default?
/// Beyond the matrix they take some 2.2 kB for each row [measured: bars of quadratic elements,
/// tests/bench/fem/RESULTS.md].
bool has_room_for_products(Eigen::Index own_nodes) {
    constexpr double gigabytes_of_a_row = 2.2e-6;
    MPI_Comm machine = MPI_COMM_NULL;
    MPI_Comm_split_type(PETSC_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
    double here = 3 * static_cast<double>(own_nodes) * gigabytes_of_a_row, on_machine = 0;
    MPI_Allreduce(&here, &on_machine, 1, MPI_DOUBLE, MPI_SUM, machine);
    MPI_Comm_free(&machine);
    return !anywhere(on_machine > usable_memory());
}

/// What PETSC_OPTIONS does not say otherwise.
void set_default_options(Eigen::Index own_nodes) {
    const auto option = [](const char* name, const char* value) {
        PetscBool is_set = PETSC_FALSE;
        check_petsc(PetscOptionsHasName(nullptr, nullptr, name, &is_set), "to read its options");
        if (!is_set) check_petsc(PetscOptionsSetValue(nullptr, name, value), "to set its options");
        return !is_set;
    };
    option("-ksp_type", "cg");
    option("-ksp_norm_type", "natural");
    option("-pc_type", "gamg");
    option("-mg_levels_ksp_type", "chebyshev");
    option("-mg_levels_pc_type", "jacobi");
    // The first process of two takes 0.44 GB in place of 0.77, and seven times the time (tests/bench/fem/RESULTS.md).
    // Options outlive a body: the next one may have room.
    static bool is_ours = false;
    if (is_ours) check_petsc(PetscOptionsClearValue(nullptr, "-matptap_via"), "to set its options");
    is_ours = !has_room_for_products(own_nodes) && option("-matptap_via", "allatonce");
}

}  // namespace

/// Nonzeros of each row of the own nodes, in own columns and in those of other processes.
struct MatrixShare::RowLengths {
    std::vector<PetscInt> own{}, others{};

    /// A node's three rows, with blocks in these columns; nodes [first, end) are the own ones.
    template <class Columns>
    void add(const Columns& columns, int first, int end) {
        const auto here = std::ranges::count_if(columns, [&](auto k) { return k >= first && k < end; });
        const auto elsewhere = static_cast<std::ptrdiff_t>(std::size(columns)) - here;
        own.insert(own.end(), 3, static_cast<PetscInt>(3 * here));
        others.insert(others.end(), 3, static_cast<PetscInt>(3 * elsewhere));
        entries_ += 9 * (here + elsewhere);
    }
    void check() const {
        constexpr auto most = static_cast<std::int64_t>(std::numeric_limits<PetscInt>::max());
        if (entries_ > most) {
            throw SolverFailure(
                fmt::format("a share of the stiffness matrix has {} entries, and PETSc of this machine counts to {}: "
                            "start more processes (mpirun -n)",
                            entries_, most));
        }
    }

private:
    std::int64_t entries_ = 0;
};

MatrixShare::MatrixShare(const BodyPart& part) {
    RowLengths lengths;
    together([&] {
        for_pieces(part, piece_size, [&](int, const BodyPart& piece) {
            const PieceNumbers numbers(piece);
            const auto lists = neighbours(piece.mesh, numbers.number, Half::both);
            std::vector<PetscInt> columns;
            for (int i = 0; i < piece.own; ++i) {
                columns.clear();
                for (const int j : lists[static_cast<std::size_t>(i)])
                    columns.push_back(numbers.global[static_cast<std::size_t>(j)]);
                lengths.add(columns, part.first, part.first + part.own);
            }
        });
        lengths.check();
    });
    make_matrix(part.own, lengths);
    together([&] { for_pieces(part, piece_size, [&](int, const BodyPart& piece) { insert_rows(piece, K_); }); });
    end_assembly();
    make_solver(part.mesh.nodes.topRows(part.own));
}

MatrixShare::MatrixShare(const MatrixRows& rows) {
    const int own = rows.blocks.rows();
    RowLengths lengths;
    together([&] {
        for (int i = 0; i < own; ++i) lengths.add(rows.blocks.columns_of(i), rows.first, rows.first + own);
        lengths.check();
    });
    make_matrix(own, lengths);
    together([&] {
        for (int i = 0; i < own; ++i) {
            const auto columns = rows.blocks.columns_of(i);
            insert(K_, rows.first + i, {columns.begin(), columns.end()}, rows.blocks.panel(i).data());
        }
    });
    end_assembly();
    make_solver(rows.positions);
}

void MatrixShare::make_matrix(int own, const RowLengths& lengths) {
    const PetscInt rows = 3 * own;
    check_petsc(MatCreate(PETSC_COMM_WORLD, &K_), assembling);
    check_petsc(MatSetSizes(K_, rows, rows, PETSC_DETERMINE, PETSC_DETERMINE), assembling);
    check_petsc(MatSetBlockSize(K_, 3), assembling);
    check_petsc(MatSetType(K_, MATAIJ), assembling);
    check_petsc(MatSeqAIJSetPreallocation(K_, 0, lengths.own.data()), assembling);
    check_petsc(MatMPIAIJSetPreallocation(K_, 0, lengths.own.data(), 0, lengths.others.data()), assembling);
}

void MatrixShare::end_assembly() {
    check_petsc(MatAssemblyBegin(K_, MAT_FINAL_ASSEMBLY), assembling);
    check_petsc(MatAssemblyEnd(K_, MAT_FINAL_ASSEMBLY), assembling);
    check_petsc(MatSetOption(K_, MAT_SYMMETRIC, PETSC_TRUE), assembling);
    check_petsc(MatSetOption(K_, MAT_SPD, PETSC_TRUE), assembling);
}

void MatrixShare::make_solver(const Eigen::Ref<const Points>& own) {
    constexpr const char* doing = "to make its solver";
    check_petsc(MatCreateVecs(K_, &displacement_, &load_), doing);
    check_petsc(VecDuplicate(load_, &residual_), doing);
    check_petsc(VecScatterCreateToZero(load_, &to_leader_, &of_leader_), doing);

    VectorHandle positions;
    check_petsc(VecDuplicate(load_, &positions), doing);
    PetscScalar* position = nullptr;
    check_petsc(VecGetArray(positions, &position), doing);
    std::copy_n(own.data(), own.size(), position);
    check_petsc(VecRestoreArray(positions, &position), doing);
    NullSpaceHandle rigid;
    check_petsc(MatNullSpaceCreateRigidBody(positions, &rigid), doing);
    check_petsc(MatSetNearNullSpace(K_, rigid), doing);

    set_default_options(own.rows());
    check_petsc(KSPCreate(PETSC_COMM_WORLD, &solver_), doing);
    check_petsc(KSPSetOperators(solver_, K_, K_), doing);
    check_petsc(KSPSetFromOptions(solver_), doing);
    check_petsc(KSPSetUp(solver_), doing);
}

double MatrixShare::solve_for_load(const ConjugateGradientsOptions& how, int& iterations, std::string& reason) {
    constexpr const char* doing = "to solve for a load";
    check_petsc(KSPSetTolerances(solver_, how.tolerance, PETSC_DEFAULT, PETSC_DEFAULT, how.iterations), doing);
    check_petsc(KSPSolve(solver_, load_, displacement_), doing);
    KSPConvergedReason why{};
    check_petsc(KSPGetConvergedReason(solver_, &why), doing);
    PetscInt taken = 0;
    check_petsc(KSPGetIterationNumber(solver_, &taken), doing);
    iterations = static_cast<int>(taken);
    if (why < 0) reason = KSPConvergedReasons[why];
    PetscReal left = 0, loaded = 0;
    check_petsc(MatMult(K_, displacement_, residual_), doing);
    check_petsc(VecAXPY(residual_, -1, load_), doing);
    check_petsc(VecNorm(residual_, NORM_2, &left), doing);
    check_petsc(VecNorm(load_, NORM_2, &loaded), doing);
    return loaded > 0 ? left / loaded : 0;
}

int MatrixShare::solve(double* x, const ConjugateGradientsOptions& how) {
    constexpr const char* doing = "to exchange loads and displacements";
    const bool leads = process_rank() == 0;
    PetscInt size = 0;
    check_petsc(VecGetSize(load_, &size), doing);
    const auto exchange = [&](Vec from, Vec to, ScatterMode mode) {
        check_petsc(VecScatterBegin(to_leader_, from, to, INSERT_VALUES, mode), doing);
        check_petsc(VecScatterEnd(to_leader_, from, to, INSERT_VALUES, mode), doing);
    };
    PetscScalar* values = nullptr;
    check_petsc(VecGetArray(of_leader_, &values), doing);
    if (leads) std::copy_n(x, size, values);
    check_petsc(VecRestoreArray(of_leader_, &values), doing);
    exchange(of_leader_, load_, SCATTER_REVERSE);

    int iterations = 0;
    std::string failure;
    const double left = solve_for_load(how, iterations, failure);
    // Where K is singular to rounding the preconditioner's own rounding looks like a solution.
    constexpr double singular = 1e-4;  // slender bodies leave 1e-7
    if (!how.truncated && (!failure.empty() || !(left <= singular))) {
        throw SolverFailure(fmt::format(
            "PETSc found no equilibrium in {} iterations ({}): relative residual {:.1e}. A part of the body may hang "
            "on the rest by one edge or corner only, be held too little, or have elements that are almost flat: repair "
            "or remesh the surface there.",
            iterations, failure.empty() ? "the matrix is singular" : failure, left));
    }
    // Truncated at once, the load itself is a direction of descent.
    PetscReal moved = 0;
    check_petsc(VecNorm(displacement_, NORM_INFINITY, &moved), doing);
    const bool is_direction = moved > 0 && std::isfinite(moved);
    exchange(is_direction ? displacement_ : load_, of_leader_, SCATTER_FORWARD);
    check_petsc(VecGetArray(of_leader_, &values), doing);
    if (leads) std::copy_n(values, size, x);
    check_petsc(VecRestoreArray(of_leader_, &values), doing);
    return iterations;
}

std::string MatrixShare::description() const {
    KSPType method = nullptr;
    PC preconditioner = nullptr;
    PCType kind = nullptr;
    KSPGetType(solver_, &method);
    KSPGetPC(solver_, &preconditioner);
    PCGetType(preconditioner, &kind);
    return fmt::format("PETSc, {} and {}, {} process{}", method ? method : "?", kind ? kind : "?", process_count(),
                       process_count() == 1 ? "" : "es");
}

}  // namespace palpate::fem
