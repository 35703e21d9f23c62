#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "identify/loading/readings.h"
#include "skeleton/statics/equilibrium.h"

namespace palpate::identify {

/// Static solvers of one model for several threads: each borrows one and gives it back. They answer alike, whichever
/// loads each of them has borne before.
class SolverPool {
public:
    /// Keeps a reference to the model. `loads`: all that the solvers will bear.
    SolverPool(const skeleton::Model& model, std::vector<skeleton::Load> loads)
        : model_(model), loads_(std::move(loads)) {
        idle_.push_back(make());
    }
    SolverPool(const skeleton::Model& model, const std::vector<StateReadings>& states)
        : SolverPool(model, loads_of(states)) {}

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

    static std::vector<skeleton::Load> loads_of(const std::vector<StateReadings>& states) {
        std::vector<skeleton::Load> loads;
        loads.reserve(states.size());
        for (const StateReadings& state : states) loads.push_back(state.load);
        return loads;
    }

    Solver make() const {
        auto solver = std::make_unique<skeleton::StaticsSolver>(model_);
        solver->expect(loads_);
        return solver;
    }

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
    std::vector<skeleton::Load> loads_;
    std::mutex mutex_;
    std::vector<Solver> idle_;
};

}  // namespace palpate::identify
