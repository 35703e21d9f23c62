#pragma once

namespace palpate::fem {

/// The processes that mpirun started this program as. The first one leads: it runs the program, and what is solved by
/// PETSc it shares with the others, which wait for their share. One object, in main.
class Processes {
public:
    /// @throws InvalidInput where mpirun started several and this program was built without PETSc.
    Processes();
    /// The leader's sends the others home.
    ~Processes();
    Processes(const Processes&) = delete;
    Processes& operator=(const Processes&) = delete;

    bool lead() const;
    /// Solves this process's share of what the leader solves, until the leader ends.
    void serve();

    /// How many there are: 1 unless mpirun started more.
    static int count();
};

}  // namespace palpate::fem
