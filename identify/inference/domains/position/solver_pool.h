#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "skeleton/statics/equilibrium.h"

namespace palpate::identify {

/// Static solvers of one model for several threads: each borrows one and gives it back.
class SolverPool {
public:
    explicit SolverPool(const skeleton::Model& model) : model_(model) { idle_.push_back(make()); }

    /// A solver on loan, until it goes out of scope.
    class Loan {
    public:
        explicit Loan(SolverPool& pool) : pool_(pool), solver_(pool.take()) {}
        ~Loan() { pool_.give_back(std::move(solver_)); }
        Loan(const Loan&) = delete;
        Loan& operator=(const Loan&) = delete;
        skeleton::StaticsSolver* operator->() const { return solver_.get(); }
        skeleton::StaticsSolver& operator*() const { return *solver_; }

    private:
        SolverPool& pool_;
        std::unique_ptr<skeleton::StaticsSolver> solver_;
    };

private:
    using Solver = std::unique_ptr<skeleton::StaticsSolver>;

    Solver make() const { return std::make_unique<skeleton::StaticsSolver>(model_); }

    Solver take() {
        {
            const std::scoped_lock lock(mutex_);
            if (!idle_.empty()) {
                Solver solver = std::move(idle_.back());
                idle_.pop_back();
                return solver;
            }
        }
        return make();
    }

    void give_back(Solver solver) {
        const std::scoped_lock lock(mutex_);
        idle_.push_back(std::move(solver));
    }

    const skeleton::Model& model_;
    std::mutex mutex_;
    std::vector<Solver> idle_;
};

}  // namespace palpate::identify
